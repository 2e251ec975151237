// SPDX-License-Identifier: BSD-3-Clause
// Prisms below cut wall faces made into one prism below each part, so that each can have layers of its own.
//
// Resolving features cuts wall faces in parts; the cell behind stays one. Between thin layers such a cell
// would see its wall's parts at a flat angle, or have no height below the cut's ends. Split along the cut it
// is two ordinary prisms: a side face goes down from the cut to the diagonal of the lower face, and that is
// cut alike, so the cell below has two faces there. Points stay, also those of the boundary.
#pragma once

#include "MeshQuality.h"

namespace pm {

/// The mesh with those of its cut prisms split that keep the limits so (minVolume but for; layers are thin on
/// purpose); cells keep their ids, new ones are appended. Faces are not in canonical order.
PolyMesh splitCutColumns(const PolyMesh& mesh, const QualityLimits& limits, Monitor& monitor);

}  // namespace pm
