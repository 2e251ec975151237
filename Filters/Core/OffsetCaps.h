// SPDX-License-Identifier: BSD-3-Clause
// Caps of the offset method (thesis 3.6.2): the wall of a coarse mesh, moved behind the holes of the
// geometry. Where a hole leaves the wall nothing to lie on, it relaxes like a soap film.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "LeakPaths.h"
#include "OctreeDecompose.h"

namespace pm {

struct Caps {
  std::vector<Vec3> points;
  std::vector<std::array<Id, 3>> triangles;
  double coarseSize = 0;  ///< feature size of the coarse octree that was used
};

/// Is a point in a room?
using InsideTest = std::function<bool(const Vec3&)>;

struct OffsetOptions {
  std::function<bool(const Caps&)> seals;  ///< do caps keep the cells in? Asked of each size that is tried
  double coarseSize = 0;                   ///< feature size for which nothing leaks
  double offset = 0;   ///< distance from the geometry to its far side, length; much less than the smallest
                       ///< cell, for the mesh's wall is drawn to the cap and to the wall it overlaps alike
  double overlap = 0;  ///< how far beyond a hole's rim its cap goes on
  double finest = 0;   ///< edge of a cap's triangles, about
  Box rooms;           ///< holds the rooms; the geometry away from it is not looked at
};

/// Caps over the given holes. inside: tells points of the rooms. Throws RegionError when the coarse octree
/// leaks as well, or is too coarse for the rooms.
Caps offsetCaps(const SurfaceModel& model, const OctreeDecomposeOptions& octree, const OffsetOptions& options,
                const InsideTest& inside, const std::vector<const Leak*>& holes, Monitor& monitor);

}  // namespace pm
