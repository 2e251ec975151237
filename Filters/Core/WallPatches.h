// SPDX-License-Identifier: BSD-3-Clause
// Which patch of the geometry a wall face belongs to (part of ResolveFeatures).
#pragma once

#include "DistanceField.h"
#include "WallSurface.h"

namespace pm {

/// Gives each wall face the patch most of its sample points (the centre and, half way to it, the vertices)
/// are closest to; a face that shares no edge with its patch takes the one around it when some of its samples
/// agree.
void assignWallPatches(PolyMesh& mesh, const DistanceField& field);

}  // namespace pm
