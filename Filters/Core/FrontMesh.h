// SPDX-License-Identifier: BSD-3-Clause
// The painted leaves as a polyhedral mesh: faces split where a neighbour is smaller, hanging nodes part of
// the faces.
#pragma once

#include <vector>

#include "Octree.h"
#include "PolyMesh.h"
#include "SurfaceModel.h"

namespace pm {

/// Cells in Morton order; front faces get the patch of the triangle closest to their centre, domain sides
/// patches xmin .. zmax behind the geometry's own.
PolyMesh frontMesh(const Octree& tree, const std::vector<std::uint8_t>& painted, const SurfaceModel& model);

}  // namespace pm
