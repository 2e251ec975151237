// SPDX-License-Identifier: BSD-3-Clause
// Columns of prismatic cells on the boundary faces of chosen patches: the topology of the far field.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "PolyMesh.h"

namespace pm {

struct SideColumns {
  std::vector<bool> extend;                             ///< #patches: a column grows on each face
  int layers = 1;                                       ///< cells in a column
  std::function<Vec3(const Vec3& x, int layer)> place;  ///< where point x of a foot goes; layer 1 .. layers
  /// Coordinates that may not move (PolyMesh::fixed) of the points above x.
  std::function<std::uint8_t(const Vec3& x, bool outermost)> fixed;
  std::string outerPatch;  ///< new patch for the outermost faces; empty = they are in the patch of their foot
};

/// The mesh with its columns, canonical. Neighbouring columns share their lateral faces; a lateral face on a
/// patch that does not grow belongs to it. Patches that grow into outerPatch, and have no faces left, are
/// dropped. Throws InputError when a wall touches a patch that grows.
PolyMesh growColumns(const PolyMesh& mesh, const SideColumns& columns);

}  // namespace pm
