// SPDX-License-Identifier: BSD-3-Clause
// Room for layers: lower ends of prism edges moved inwards, below their wall points (thesis 4.5.3).
//
// The prisms that painting and features leave may be lower than the layers wanted, or lean away from a wall
// face that thin layers could then not stand on. The lower ends of such edges are moved, and the points below
// them evened out, as far as every cell stays within the limits. Wall points do not move.
#pragma once

#include "LayerColumns.h"
#include "MeshQuality.h"
#include "WallSight.h"

namespace pm {

/// wanted: #P by lower point, length that the edge should have at least, 0 = as it is. The columns are those
/// of the mesh; they depend on its topology alone.
void makeLayerRoom(PolyMesh& mesh, const LayerColumns& columns, const WallSight& sight,
                   const std::vector<double>& wanted, const QualityLimits& limits, Monitor& monitor);

}  // namespace pm
