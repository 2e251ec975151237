// SPDX-License-Identifier: BSD-3-Clause
// The regions that painting finds: face-connected sets of leaves that no triangle touches (thesis 3.4.2),
// and of those that link them in thin places (see ThinPlaces.h).
//
// All work is O(leaves), parallel, and gives the same numbers for any number of threads.
#pragma once

#include <vector>

#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

struct PaintedRegion {
  Id cells = 0;
  double volume = 0;
  bool open = false;          ///< reaches the sides of the brick
  bool chosen = false;        ///< part of the mesh
  Box bounds;                 ///< of its leaves
  Vec3 point = Vec3::Zero();  ///< a point inside: the centre of its largest leaf
  std::vector<Id> patches;    ///< patches of the triangles in the cut leaves beside it, ascending
};

struct Regions {
  std::vector<Id> ofLeaf;           ///< #L region of each leaf, kNone for a leaf that is cut and no link
  std::vector<PaintedRegion> list;  ///< largest volume first, ties by the smaller leaf
};

/// Face-connected sets of the leaves with member != 0: a number for each leaf, kNone for the others. Sets are
/// numbered by their smallest leaf.
std::vector<Id> connectedLeaves(const Octree& tree, const std::vector<std::uint8_t>& member);

/// All regions of the tree. Their patches need the tree's lists of triangles.
Regions findRegions(const Octree& tree, const SurfaceModel& model);

/// The triangles that touch each cut leaf, for a tree that came without its lists; O(cut leaves).
void listTriangles(Octree& tree, const SurfaceModel& model);

}  // namespace pm
