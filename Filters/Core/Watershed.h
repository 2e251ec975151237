// SPDX-License-Identifier: BSD-3-Clause
// Inside and outside of a geometry with holes: the limit of the coarse-to-fine painting of thesis 3.6.1.
//
// Painting with ever smaller cells fills a room before it gets through its doors. Flooding free leaves in the
// order of falling clearance does the same in one pass over one octree: basins grow from the roomiest places,
// and where the outside meets a basin is the bottleneck of a hole. Two passes: findPockets joins basins with
// a union-find and tells which are rooms behind a narrow opening; floodSides grows the chosen rooms and the
// outside against each other, so that every leaf belongs to the side it is reached from by the wider way.
//
// Deterministic: leaves go by clearance, then by id.
#pragma once

#include <cstdint>
#include <vector>

#include "Monitor.h"
#include "Octree.h"

namespace pm {

enum class Side : std::uint8_t { None = 0, Inside = 1, Outside = 2 };

/// A room that is connected to the outside by something much narrower than itself.
struct Pocket {
  Id peak = kNone;           ///< leaf of the largest clearance
  double peakClearance = 0;  ///< length
  double saddle = 0;         ///< clearance where the outside gets in, over leaf centres; length
  double volume = 0;         ///< free leaves that are reached from the peak by the wider way
};

struct Pockets {
  std::vector<Pocket> pockets;   ///< largest volume first
  std::vector<Id> pocketOfLeaf;  ///< #L row of `pockets`, kNone for outside, cut and enclosed leaves
};

/// clearance, graph: see Clearance.h; outside: leaves known to be outside; roominess: a basin is a pocket
/// when its peak has at least this many times the clearance of its widest way out, and its volume is at least
/// smallestVolume.
Pockets findPockets(const Octree& tree, const std::vector<double>& clearance, const Csr<Id>& graph,
                    const std::vector<Id>& outside, double roominess, double smallestVolume);

/// A leaf to flood from, and the width of the ways that start there.
struct Marker {
  Id leaf;
  double width;  ///< a clearance
};

/// #L side of each leaf that is reached from the given leaves. A leaf goes to the side with the wider way to
/// it; where both ways are within a tenth as wide to the inside, so that a passage of even width is closed at
/// its outer end.
std::vector<Side> floodSides(const Octree& tree, const std::vector<double>& clearance, const Csr<Id>& graph,
                             const std::vector<Marker>& inside, const std::vector<Id>& outside);

}  // namespace pm
