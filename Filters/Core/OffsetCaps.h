// SPDX-License-Identifier: BSD-3-Clause
// Caps of the offset method (thesis 3.6.2): the wall of a coarse mesh, moved behind the holes of the
// geometry.
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
  double coarseSize = 0;  ///< feature size for which nothing leaks
  double offset = 0;  ///< distance from the geometry to its far side, length; less than the smallest cell, so
                      ///< that no cell fits between a cap and the wall it overlaps
  double overlap = 0;  ///< how far beyond a hole's rim its cap goes on
  double finest = 0;   ///< edge of a cap's triangles, about
};

/// Caps over the given holes. inside: tells points of the rooms. Throws RegionError when the coarse octree
/// leaks as well, or is too coarse for the rooms.
Caps offsetCaps(const SurfaceModel& model, const OctreeDecomposeOptions& octree, const OffsetOptions& options,
                const InsideTest& inside, const std::vector<const Leak*>& holes, Monitor& monitor);

}  // namespace pm
