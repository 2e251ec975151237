// SPDX-License-Identifier: BSD-3-Clause
// Holes closed before meshing: the geometry with a patch "closed_holes" that keeps the octree from leaking
// (thesis 3.6).
//
// Two ways. CoarseToFine (3.6.1): the thesis paints with cells from coarse to fine and blocks bottleneck
// cells; its limit, one watershed over one octree, gives a membrane in each hole (Membrane.h). Offset
// (3.6.2): a coarse octree that does not leak is meshed, and its wall, moved through the holes to the far
// side of the geometry by a tenth of a cell, covers them; only what covers a hole is kept, for elsewhere
// the geometry itself is finer.
//
// Either is verified: the octree of the closed geometry is searched again, and what still leaks is closed in
// turn.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "LeakPaths.h"
#include "OctreeDecompose.h"

namespace pm {

enum class HoleMethod : std::uint8_t {
  ShowOnly = 0,      ///< find leaks, change nothing
  CoarseToFine = 1,  ///< a membrane in each hole
  Offset = 2,        ///< the wall of a coarse mesh behind each hole
};

struct CloseHolesOptions {
  HoleMethod method = HoleMethod::CoarseToFine;
  LeakOptions search;
  double maximumWidth = 0;  ///< holes wider than this stay open, length; 0 = all are closed
};

struct Hole {
  Leak leak;
  bool closed = false;
};

struct CloseHolesReport {
  std::vector<Hole> holes;  ///< widest first
  std::vector<Pocket> pockets;
  double coarseSize = 0;  ///< feature size of the coarse octree of the offset method
  Id addedTriangles = 0;
  bool tight = true;  ///< no leak is left but holes wider than asked for
};

/// Name of the patch that closes holes.
extern const char* const kClosedHolesPatch;

/// The model with its holes closed; a copy of it when there are none. Throws InputError and RegionError as
/// findLeaks does.
std::unique_ptr<SurfaceModel> closeHoles(const SurfaceModel& model, const OctreeDecomposeOptions& octree,
                                         const CloseHolesOptions& options, Monitor& monitor,
                                         CloseHolesReport* report = nullptr);

/// What is known of root cells before the octree is made.
RootCells rootCellsOf(const OctreeDecomposeOptions& octree);

}  // namespace pm
