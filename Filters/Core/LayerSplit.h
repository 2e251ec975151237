// SPDX-License-Identifier: BSD-3-Clause
// The mesh in which columns are cut into the layers chosen for them.
#pragma once

#include "LayerColumns.h"

namespace pm {

/// candidates: the mesh's points and behind them those on the columns' edges, as the columns number them; the
/// layers may have become fewer since. The wall's cell of a column keeps the cell's id, and the mesh's points
/// theirs. The result is canonical. Numbers the columns' points anew.
PolyMesh splitLayers(const PolyMesh& mesh, LayerColumns& columns, const std::vector<Vec3>& candidates);

}  // namespace pm
