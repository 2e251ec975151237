// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: a balanced octree around the geometry, refined where the geometry needs it (thesis 3.2-3.4).
#pragma once

#include <memory>
#include <utility>

#include "Monitor.h"
#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

struct RefineBox {
  Box box;
  double size = 0;  ///< cells that touch the box are at most this large
};

struct RefineSphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0, size = 0;
};

/// A solid cylinder with flat ends.
struct RefineCylinder {
  Vec3 start = Vec3::Zero(), end = Vec3::Zero();  ///< of its axis
  double radius = 0, size = 0;
};

/// Cells that come within `distance` of the patch are at most this large; distance 0 = cells on it.
struct PatchDistance {
  std::string patch;
  double distance = 0, size = 0;
};

/// The same for the size surface.
struct SurfaceDistance {
  double distance = 0, size = 0;
};

/// Which edges with a triangle on one side only are critical (criterion 5).
enum class OpenEdgeRefinement : std::uint8_t {
  None,
  Seams,  ///< those close to the surface they ought to be stitched to
  All
};

/// How deep cells on critical edges and points are split.
enum class FeatureDepth : std::uint8_t {
  AsNeeded,  ///< until one cell holds no two features that must be told apart
  Full       ///< to the finest level
};

struct OctreeDecomposeOptions {
  double featureSize =
      0;                ///< l_feat, length: the smallest cell is at most this large; 0 = 1/50 of the diagonal
  int maxLevel = -1;    ///< instead of featureSize, when >= 0: level of the smallest cells
  double baseSize = 0;  ///< edge of the root cells; 0 = chosen from the geometry's box
  bool useDomain = false;  ///< mesh the given box; its sides become patches xmin .. zmax
  Box domain;
  double margin = 2;  ///< cells of base size around the geometry's own box when no domain is given

  // Criteria of thesis 3.4.4, in its order.
  double normalAngle = 40;          ///< 1, 2: degrees between normals that ask for refinement; 0 = off
  bool cellNormals = true;          ///< 1: within a cell
  bool neighbourNormals = true;     ///< 2: of adjacent cells
  bool separate = true;             ///< 3, 4: facing surfaces
  double closeAngle = 45;           ///< 3, 4: degrees, alpha_close
  bool cellSeparation = true;       ///< 3: within a cell
  bool neighbourSeparation = true;  ///< 4: in adjacent cells
  bool refineEdges = true;          ///< 5, 7: critical edges and points at all
  double sharpAngle = 30;           ///< 5: dihedral angle of sharp edges
  bool refineSharp = true;          ///< 5: sharp edges
  bool refineInterfaces = true;     ///< 5: edges between patches
  OpenEdgeRefinement refineOpen = OpenEdgeRefinement::Seams;  ///< 5: open edges
  bool refineCorners = true;                                  ///< 5: ends and joints of critical edges
  FeatureDepth featureDepth = FeatureDepth::AsNeeded;
  int cellsBetweenLevels = 1;  ///< 6, growth: cells of one level before the next coarser one; 1 = balance
  int featureBuffer = 1;       ///< 7: cells of the finest size around a critical edge
  int bufferCells = 1;         ///< 8: cells of the same level beside a cell that touches the geometry
  std::vector<std::pair<std::string, double>> patchSizes;  ///< 9: patch name, largest cell on it

  // Sizes of our own.
  double surfaceSize = 0;  ///< largest cell that touches the geometry; 0 = no limit but the criteria
  std::vector<RefineBox> boxes;
  std::vector<RefineSphere> spheres;
  std::vector<RefineCylinder> cylinders;
  std::vector<PatchDistance> patchDistances;
  std::vector<SurfaceDistance> surfaceDistances;
  std::shared_ptr<const SurfaceModel> sizeSurface;  ///< what surfaceDistances refer to; never meshed itself
  int gapCells = 0;        ///< free cells across gaps between facing surfaces; 0 = off
  int cellsPerCircle = 0;  ///< cells around a circle as curved as the surface; 0 = off

  std::int64_t maxCells = 20'000'000;  ///< budget; a larger estimate is an error
  double maxMemory = 0;                ///< budget of the whole mesh, GB (1e9 bytes); 0 = none
};

/// Throws InputError for options that contradict each other or the geometry, BudgetError before memory is
/// spent.
Octree decompose(const SurfaceModel& model, const OctreeDecomposeOptions& options, Monitor& monitor);

}  // namespace pm
