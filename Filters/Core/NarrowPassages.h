// SPDX-License-Identifier: BSD-3-Clause
// Free space that painting cannot enter because no leaf fits: geometry that has become invisible
// (thesis 3.4.2, Fig. 3-17), with the feature size that would show it.
//
// 1. A straight line across, from a piece of surface to the next that faces it (normals within 45
//    degrees), is a gap when it is shorter than what surely holds leaves; pieces nearer than 1/20 of a leaf
//    are a seam.
// 2. A gap is free when its middle is in sight of a painted leaf at most two leaves away, or of the middle
//    of a free gap beside it. Lines of sight stop at every triangle, so the inside of thin walls is never
//    free.
// 3. Free gaps that no painted leaf sees are hidden; hidden gaps in adjacent leaves are one place.
//
// Gaps are measured only where a line of sight arrives, so the work grows with what is narrow. A groove of
// less than three leaves' depth is seen from its mouth and no place. Same result for any number of threads.
#pragma once

#include <vector>

#include "Monitor.h"
#include "Octree.h"
#include "Regions.h"
#include "SurfaceModel.h"

namespace pm {

/// A leaf that no cell represents although it is in free space.
struct NarrowCell {
  Vec3 point = Vec3::Zero();  ///< middle of the gap
  double width = 0;           ///< from triangle to triangle, the narrowest way across, length
  double featureSize = 0;     ///< see featureSizeShowing()
  Id place = kNone;
};

struct NarrowPlace {
  Id cells = 0;
  Vec3 centre = Vec3::Zero();        ///< mean of its cells' points
  Box bounds;                        ///< of its cells' points
  double narrowest = 0, median = 0;  ///< widths, length
  double featureSize = 0;            ///< shows the wider half of the place
  std::vector<Id> patches;           ///< of the triangles on either side, ascending
  Id leadsTo = kNone;  ///< the largest region it opens into that is not in the mesh, kNone = none
};

struct NarrowPassages {
  std::vector<NarrowCell> cells;    ///< by place
  std::vector<NarrowPlace> places;  ///< most cells first, ties by the smaller leaf
};

/// Leaves of this edge surely fit into a gap between parallel planes of unit normal n = `across`, and hang
/// together by faces. A lattice line along the axis nearest to n has a whole cell of edge h between planes
/// that are h (|nx| + |ny| + |nz| + largest |n|) apart; lines side by side share one with h times the middle
/// |n| more. In all h (2 (|nx| + |ny| + |nz|) - smallest |n|): 2 h along an axis.
double featureSizeShowing(double width, const Vec3& across);

/// painted: #L leaves of the mesh; regions: of the tree, with those in the mesh chosen. The tree needs its
/// lists of triangles; a tree without them has no narrow passages.
NarrowPassages findNarrowPassages(const Octree& tree, const SurfaceModel& model,
                                  const std::vector<std::uint8_t>& painted, const Regions& regions,
                                  Monitor& monitor);

}  // namespace pm
