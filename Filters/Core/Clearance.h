// SPDX-License-Identifier: BSD-3-Clause
// How far the free leaves of an octree are from the geometry, and how they hang together: what holes are
// found by.
//
// A leaf is free when no triangle touches it. Its clearance is the distance of its centre to the geometry,
// hence at least half its edge. A way through free leaves of edge h keeps h/2 away from the geometry
// everywhere, also between the centres; so cells larger than a hole's narrowest width cannot pass it,
// wherever they lie.
#pragma once

#include <vector>

#include "Monitor.h"
#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

/// #L distance of each free leaf's centre to the geometry, length; negative for a leaf that is cut. Parallel.
/// `known` leaves all of whose free neighbours are known too are not measured: they get half their edge.
std::vector<double> leafClearance(const Octree& tree, const SurfaceModel& model, Monitor& monitor,
                                  const std::vector<Id>& known = {});

/// #L rows: free leaves across the faces of each free leaf, in the order of sides; empty rows for cut leaves.
Csr<Id> freeNeighbours(const Octree& tree);

/// Free leaves of the outside: at the given points, else at the corners of the brick, else, when the geometry
/// covers every corner, at its sides. Throws RegionError when a point is in no free leaf.
std::vector<Id> outsideLeaves(const Octree& tree, const std::vector<Vec3>& points);

/// The free leaf that holds a point; throws RegionError with a sentence that names the point.
Id freeLeafAt(const Octree& tree, const Vec3& point);

}  // namespace pm
