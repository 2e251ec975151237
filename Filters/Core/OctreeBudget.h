// SPDX-License-Identifier: BSD-3-Clause
// Refuses an octree that would be too large, before the memory is spent.
//
// Each level's splits are known before they are made. Beyond them, cells that were split for a size or a
// feature will be split again down to a known level: such volumes grow by 8 a level, surfaces by 4, lines by
// 2, or by less when the last level showed less. Cells split for normals, gaps and the like may stop at any
// level and are not foreseen. The forecast is thus rather too low than too high, and made only where many
// cells ask.
#pragma once

#include <array>

#include "OctreeBuilder.h"
#include "OctreeDecompose.h"
#include "RefinementCriteria.h"

namespace pm {

class OctreeBudget {
 public:
  /// What a mesh takes in memory for each leaf of its octree while all stages run.
  static constexpr double kBytesALeaf = 1000;

  OctreeBudget(const OctreeDecomposeOptions& options, const Brick& brick)
      : options_(options), brick_(brick) {}

  /// For splits by the criteria, level by level; throws BudgetError.
  void check(const OctreeBuilder& builder, const RefinementCriteria::Choice& choice, int level);
  /// For any other splits.
  void check(const OctreeBuilder& builder, std::size_t splits) const;

 private:
  enum Kind { kLine, kSurface, kVolume, kKinds };
  static int kindOf(RefineReason reason);
  void refuse(double leaves, const char* source) const;

  const OctreeDecomposeOptions& options_;
  const Brick brick_;
  std::array<double, kKinds> before_{};  // cells of each kind split at the level before
};

}  // namespace pm
