// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeBudget.h"

#include <fmt/format.h>

#include <algorithm>

namespace pm {

namespace {
constexpr double kFew = 64;  // fewer cells say nothing about how their number grows
}  // namespace

int OctreeBudget::kindOf(RefineReason reason) {
  switch (reason) {
    case RefineReason::Feature:
    case RefineReason::FeatureBuffer:
      return kLine;
    case RefineReason::PatchSize:
    case RefineReason::SurfaceSize:
      return kSurface;
    case RefineReason::Box:
    case RefineReason::Sphere:
    case RefineReason::Cylinder:
    case RefineReason::PatchDistance:
    case RefineReason::SurfaceDistance:
      return kVolume;
    default:
      return kKinds;
  }
}

void OctreeBudget::check(const OctreeBuilder& builder, const RefinementCriteria::Choice& choice, int level) {
  check(builder, choice.leaves.size());
  std::array<double, kKinds> now{};
  std::array<std::array<double, kMaxLevel + 1>, kKinds>
      bound{};  // cells of each kind by the level they ask for
  for (const RefineCause& cause : choice.causes) {
    const int kind = kindOf(cause.reason);
    if (kind == kKinds || cause.level <= level) continue;
    ++now[kind];
    ++bound[kind][cause.level];
  }
  double leaves = double(builder.leafCount()) + 7.0 * double(choice.leaves.size());
  for (int kind = 0; kind < kKinds; ++kind) {
    const double most = 2 << kind;
    const double growth = before_[kind] > 0 ? std::min(most, now[kind] / before_[kind]) : 0;
    for (int target = level + 2; target <= brick_.maxLevel && now[kind] >= kFew; ++target) {
      double splits = bound[kind][target];
      for (int l = level + 1; l < target; ++l) leaves += 7 * (splits *= growth);
    }
  }
  before_ = now;
  refuse(leaves, "foreseen");
}

void OctreeBudget::check(const OctreeBuilder& builder, std::size_t splits) const {
  refuse(double(builder.leafCount()) + 7.0 * double(splits), "needed");
}

void OctreeBudget::refuse(double leaves, const char* source) const {
  const double bytes = leaves * kBytesALeaf;
  if (leaves > double(options_.maxCells))
    throw BudgetError(fmt::format(
        "About {:.3g} octree cells are {} (a mesh of some {:.2g} GB), more than the {} allowed; use a "
        "larger feature size or larger cell sizes, or raise the limit on cells.",
        leaves, source, bytes / 1e9, options_.maxCells));
  if (options_.maxMemory > 0 && bytes > 1e9 * options_.maxMemory)
    throw BudgetError(fmt::format(
        "About {:.2g} GB of memory are {} for {:.3g} octree cells, more than the {:g} GB allowed; use a "
        "larger feature size or larger cell sizes, or raise the limit on memory.",
        bytes / 1e9, source, leaves, options_.maxMemory));
}

}  // namespace pm
