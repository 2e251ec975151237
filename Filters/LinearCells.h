// SPDX-License-Identifier: BSD-3-Clause
// Faces of chosen cells of any vtkUnstructuredGrid, as the kernel takes them.
#pragma once

#include <vector>

#include "Types.h"
#include "vtkType.h"

class vtkUnstructuredGrid;

namespace pm {

/// Cells as rows of faces, faces as rows of points of the grid; each cell has faces of its own.
struct FaceRows {
  Csr<Id> faces, cells;
};

/// Whether a cell of this type is a solid with straight edges: a tetrahedron, voxel, hexahedron, wedge,
/// pyramid, pentagonal or hexagonal prism, or a polyhedron.
bool hasStraightEdges(int vtkType);

/// The faces of chosen cells, all of them of such types. filter: the asking filter's name, for messages.
/// Throws InputError when a cell is damaged.
FaceRows facesOf(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& chosen, const std::string& filter);

}  // namespace pm
