// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: which leaves are the domain, and a front that a prism layer can grow on (thesis 3.4.2, 3.5).
#pragma once

#include "Monitor.h"
#include "Octree.h"
#include "PolyMesh.h"
#include "SurfaceModel.h"

namespace pm {

enum class Region : std::uint8_t {
  Inside = 0,   ///< the largest enclosed region
  Outside = 1,  ///< everything connected to the domain's sides
  Points = 2,   ///< the regions that hold the given points
};

struct PaintFrontOptions {
  Region region = Region::Inside;
  std::vector<Vec3> points;  ///< for Region::Points
  bool allowOpen = false;  ///< accept a region of given points that reaches the sides of an undeclared domain
  bool fill = true;        ///< front filling (Fig. 3-33)
};

/// One face-connected set of leaves that no triangle touches.
struct PaintedRegion {
  Id cells = 0;
  double volume = 0;
  bool open = false;  ///< reaches the sides of the brick
};

struct PaintFrontReport {
  std::vector<PaintedRegion> regions;  ///< largest volume first
  Id chosenCells = 0, grown = 0, removed = 0, filled = 0;
};

/// The domain's leaves as a mesh: cells in Morton order, front faces as boundary faces of patch 0.. by the
/// closest triangle, domain sides in patches of their own. Every front node is in a permitted pattern (Fig.
/// 3-31). Throws RegionError when nothing is enclosed, a point lies outside or on the geometry, or the region
/// leaks.
PolyMesh paintFront(const Octree& tree, const SurfaceModel& model, const PaintFrontOptions& options,
                    Monitor& monitor, PaintFrontReport* report = nullptr);

/// Eight octants around a node, bit (x + 2y + 4z) set = painted: may a front pass here?
bool isPermittedPattern(unsigned octants);

}  // namespace pm
