// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: a balanced octree around the geometry, refined where the geometry needs it (thesis 3.2-3.4).
#pragma once

#include <utility>

#include "FeatureEdges.h"
#include "Monitor.h"
#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

struct RefineBox {
  Box box;
  double size = 0;  ///< cells that touch the box are at most this large
};

struct OctreeDecomposeOptions {
  double featureSize =
      0;                ///< l_feat, length: the smallest cell is at most this large; 0 = 1/50 of the diagonal
  int maxLevel = -1;    ///< instead of featureSize, when >= 0: level of the smallest cells
  double baseSize = 0;  ///< edge of the root cells; 0 = chosen from the geometry's box
  bool useDomain = false;  ///< mesh the given box; its sides become patches xmin .. zmax
  Box domain;
  double margin = 2;  ///< cells of base size around the geometry's own box when no domain is given
  std::vector<std::pair<std::string, double>> patchSizes;  ///< patch name, largest cell on it
  double surfaceSize = 0;  ///< largest cell that touches the geometry; 0 = no limit but the criteria
  std::vector<RefineBox> boxes;
  double normalAngle = 40;  ///< criteria 1, 2: degrees between normals within a cell that ask for refinement
  double sharpAngle = 30;   ///< criterion 5: dihedral angle of sharp edges
  bool refineEdges = true;  ///< cells on sharp edges, patch interfaces and corners go to the finest level
  bool separate = true;     ///< criteria 3, 4: facing surfaces in one cell or in adjacent cells
  double closeAngle = 45;   ///< degrees, alpha_close of the separating criterion
  int bufferCells = 1;      ///< cells of the same level beside a cell that touches the geometry
  int cellsBetweenLevels = 1;          ///< growth: cells of one level before the next coarser one
  std::int64_t maxCells = 20'000'000;  ///< budget; a larger estimate is an error
};

/// Throws InputError for options that contradict each other or the geometry, BudgetError before memory is
/// spent.
Octree decompose(const SurfaceModel& model, const OctreeDecomposeOptions& options, Monitor& monitor);

}  // namespace pm
