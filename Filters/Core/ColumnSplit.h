// SPDX-License-Identifier: BSD-3-Clause
// Prism columns cut in two along a line across their wall faces, with new points where the line crosses a
// wall edge (thesis 4.4.2, cell splitting, Fig. 4-21 f).
//
// Each column that the line crosses becomes two prisms with a side face between them. The faces below and
// beside it are cut as well; the cells behind keep their shape, with one face more. So whatever is a prism
// stays one, and can be split into layers.
#pragma once

#include <vector>

#include "SubMesh.h"

namespace pm {

/// A place on the wall: the point a, or, where b is a point too, a new one in the middle of the edge a-b.
struct WallPlace {
  Id a = kNone, b = kNone;
  bool isNew() const { return b != kNone; }
};

/// A line over the wall from place to place; faces[i] lies between places i and i + 1. Or one edge, to be
/// split alone: one place and a face beside it.
struct WallPath {
  std::vector<WallPlace> places;
  std::vector<Id> faces;
  bool isEdge() const { return places.size() == 1; }
};

/// The path in ids of a part that holds its faces.
WallPath pathIn(const SubMesh& part, WallPath path);

/// Are a and b neighbours in a face's row?
bool hasEdge(Span<Id> row, Id a, Id b);

/// Can the columns below the path be split? Their cells must be different prisms, each with a face below
/// that holds the lower ends of both places; a new point's edge must have a quad between two columns below.
bool canSplitColumns(const PolyMesh& mesh, const Csr<Id>& facesOfCell, const WallPath& path);

/// Splits the columns below the paths, of which no two may split the same. Two new points for each new place,
/// in the order in which the paths first name them: one on the wall and its base below. Points and cells keep
/// their ids, new ones come behind; faces get new ids.
void splitColumns(PolyMesh& mesh, const Csr<Id>& facesOfCell, const std::vector<WallPath>& paths);

}  // namespace pm
