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

/// Faces around a point, weighted by area, so that hanging nodes on their edges do not count.
struct FacesAround {
  Vec3 middle = Vec3::Zero();  ///< mean of their centres, relative to the point
  Vec3 normal = Vec3::Zero();  ///< sum of their area vectors
  bool haveArea = false;
};
/// centre(f) and normal(f) are those of a face.
template <class Centre, class Normal>
FacesAround facesAround(Span<Id> faces, const Vec3& at, const Centre& centre, const Normal& normal) {
  FacesAround around;
  double weight = 0;
  for (Id f : faces) {
    const double area = normal(f).norm();
    around.middle += area * (centre(f) - at);
    weight += area;
    around.normal += normal(f);
  }
  around.haveArea = weight > 0;
  if (around.haveArea) around.middle /= weight;
  return around;
}

}  // namespace pm
