// SPDX-License-Identifier: BSD-3-Clause
// External flow: prismatic cells from the sides of the meshed domain out to a far box or sphere (thesis
// 3.3.2, Fig. 3-12), so that the octree need not reach the far boundary.
//
// Each face of an extended side becomes a column of cells. Nodes run along straight rays of a similarity:
// in the inner part of a side square to it, in the outer part fanning out to the corner of the far box,
//
//   x + s (x - closest point of the core),   core = the domain shrunk by its smallest half width,
//
// so that a long domain shears its cells no more than a cube does: rays lean at most 55 degrees where the
// distances to the far box are alike. Very different distances are bridged in several steps of like ones. For
// a sphere each ray ends where the line from the centre through its end on a far box meets the sphere. Sides
// that are not extended stay planes: rays that start on one run in it.
//
// Guarantees: the inner cells are as they were; every new cell is within the limits, or the call throws; the
// result is the same for any number of threads.
#pragma once

#include <array>

#include "MeshQuality.h"

namespace pm {

enum class FarShape : std::uint8_t { Box = 0, Sphere };

struct FarFieldOptions {
  FarShape shape = FarShape::Box;
  std::array<bool, 6> extend{true, true, true, true, true, true};  ///< xmin, xmax, ymin, .. zmax
  double distance = 0;  ///< from the domain to the far boundary; 0 = twice the domain's longest edge
  bool useBounds = false;
  Box bounds;                   ///< far box instead of the distance; of sides that stay nothing is read
  double radius = 0;            ///< of the sphere, instead of the distance when above 0
  double expansionRatio = 1.2;  ///< most that a cell is thicker than the one before it in its column
  int maxLayers = 60;           ///< cells in a column, for each step
  QualityLimits
      limits;  ///< of a finished mesh, which has layers, those on volume and degradation ask for > 0
};

struct FarFieldReport {
  int steps = 0;        ///< rounds of columns; more than one for a box with very different distances
  int layers = 0;       ///< cells in the longest columns
  Id cells = 0;         ///< that were added
  double volume = 0;    ///< of those
  double growth = 1;    ///< largest thickness of a cell over the one before it
  double maxAngle = 0;  ///< degrees, worst internal face of a far cell
};

/// mesh: of any stage from PaintFront on, made in a given domain, so that it has side patches xmin .. zmax.
///
/// The stage and the arrays stay: a far cell has layer 0 and the level of the cell at its column's foot. The
/// faces of the far box are in the patches xmin .. zmax, those of the sphere in the patch "far"; lateral
/// faces on a side that stays are in that side's patch. A sphere is centred on the domain, on the planes of
/// sides that stay: half a sphere on the ground, and a cylinder between two opposite sides that stay.
///
/// Throws InputError when there is no such side, the far boundary is not outside the domain, the geometry
/// touches a side that is to be extended, or the cells cannot be valid.
PolyMesh farField(const PolyMesh& mesh, const FarFieldOptions& options, Monitor& monitor,
                  FarFieldReport* report = nullptr);

}  // namespace pm
