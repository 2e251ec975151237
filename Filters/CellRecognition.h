// SPDX-License-Identifier: BSD-3-Clause
// Which linear VTK cell, if any, has exactly the faces of a polyhedral cell. Topology only: no coordinates
// are read.
#pragma once

#include "vtkType.h"

#include <vector>

#include "PolyMesh.h"

namespace pm {

struct RecognisedCell {
  int vtkType = 0;                ///< VTK_HEXAHEDRON, VTK_WEDGE, VTK_TETRA, VTK_PYRAMID or VTK_POLYHEDRON
  std::vector<vtkIdType> points;  ///< in VTK's order; a polyhedron's ascend
};

/// Reuses its buffers from cell to cell; use one for each thread.
class CellRecogniser {
 public:
  /// faces: the cell's, ascending. The answer is good until the next call.
  const RecognisedCell& recognise(const PolyMesh& mesh, Span<Id> faces, Id cell);

 private:
  bool prism(std::size_t corners);
  bool pyramid(std::size_t corners);
  void polyhedron();
  std::size_t firstFaceOf(std::size_t corners) const;
  const Id* after(std::size_t face, Id from, Id to) const;

  std::vector<std::vector<Id>> rows_;  // the first count_ are the cell's faces, outward
  std::size_t count_ = 0;
  RecognisedCell found_;
};

}  // namespace pm
