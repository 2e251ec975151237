// SPDX-License-Identifier: BSD-3-Clause
// The wall of a mesh as a graph of nodes and edges: who neighbours whom on it, and the local length scale (eq
// 4-2).
#pragma once

#include "PolyMesh.h"

namespace pm {

/// Rows are wall nodes in ascending point id; all ids inside are rows, faces are the mesh's face ids.
struct WallSurface {
  std::vector<Id> nodes;      // #W point ids, ascending
  std::vector<Id> rowOf;      // #P row of a point, kNone off the wall
  Csr<Id> neighbours;         // #W rows joined by a wall edge, ascending
  Csr<Id> faces;              // #W wall faces around the node, ascending
  std::vector<double> scale;  // #W mean length of the wall edges at the node and at its neighbours

  Id size() const { return static_cast<Id>(nodes.size()); }
};

WallSurface wallSurface(const PolyMesh& mesh);

}  // namespace pm
