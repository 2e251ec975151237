// SPDX-License-Identifier: BSD-3-Clause
// Some cells of a mesh as a mesh of its own, in which something can be tried out.
#pragma once

#include "PolyMesh.h"

namespace pm {

struct SubMesh {
  PolyMesh mesh;           // its last patch, of type "patch", is where it was cut out
  std::vector<Id> points;  // of the whole mesh, ascending: point i of the part is points[i]
  std::vector<Id> cells;   // the same of cells
  std::vector<Id> faces;   // #F of the whole mesh

  /// Point of the part that a point of the whole mesh is, kNone when it is none.
  Id pointOf(Id whole) const;
  /// The same for a boundary face of the whole mesh.
  Id boundaryFaceOf(Id whole) const;
};

/// cells: ascending. facesOfCell: of the whole mesh. Points, cells and faces keep their order; zones are left
/// out.
SubMesh subMesh(const PolyMesh& mesh, const Csr<Id>& facesOfCell, std::vector<Id> cells);

}  // namespace pm
