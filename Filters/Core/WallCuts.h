// SPDX-License-Identifier: BSD-3-Clause
// Wall faces cut in two along a diagonal (thesis 4.4.2, 4.7.3): a feature may then run across a face.
//
// The cell behind stays one cell with two wall faces. Points and cells keep their ids; so do internal faces.
#pragma once

#include <vector>

#include "PolyMesh.h"

namespace pm {

/// A cut of a wall face between two of its points that are not neighbours in it.
struct WallCut {
  Id face = kNone;
  Id a = kNone, b = kNone;
};

/// The two parts of a face: from a to b along the face, and from b to a.
void cutRow(Span<Id> row, Id a, Id b, std::vector<Id>& first, std::vector<Id>& second);

/// Cuts the faces, one cut a face at most (the first of several counts); the parts lie where the face lay in
/// the order of faces. Boundary faces get new ids.
void cutWallFaces(PolyMesh& mesh, std::vector<WallCut> cuts);

}  // namespace pm
