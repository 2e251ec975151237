// SPDX-License-Identifier: BSD-3-Clause
// Wall faces cut in two along a diagonal, and merged again (thesis 4.4.2, 4.7.3): a feature may then run
// across a face.
//
// The cell behind stays one cell, with two wall faces once one is cut. Points and cells keep their ids; so do
// internal faces. Boundary faces get new ones, in the order in which the faces lay that they are made of.
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

/// Cuts the faces, one cut a face at most (the first of several counts), but not where the cut's edge is one
/// of the boundary already. Returns the cuts made, ascending by face.
std::vector<WallCut> cutWallFaces(PolyMesh& mesh, std::vector<WallCut> cuts);

/// Two wall faces of one cell and one patch that share one edge and nothing else. `first` runs along it from
/// b to a: the two are what a cut from a to b makes.
struct WallMerge {
  Id first = kNone, second = kNone;
  Id a = kNone, b = kNone;
};

/// All of them, ascending by their smaller face; a face may be in several.
std::vector<WallMerge> wallPairs(const PolyMesh& mesh);

/// The row of which cutRow(row, a, b) makes the two.
std::vector<Id> mergedRow(Span<Id> first, Span<Id> second, Id a, Id b);

/// Merges pairs of faces; a face takes part in one merge at most (the first of several counts).
void mergeWallFaces(PolyMesh& mesh, const std::vector<WallMerge>& merges);

}  // namespace pm
