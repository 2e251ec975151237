// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeDecompose.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>

#include "OctreeBrick.h"
#include "OctreeBudget.h"
#include "OctreeBuilder.h"
#include "RefinementCriteria.h"

namespace pm {
namespace {

// Pass 1: criteria 1-5, 7 and 9 and the sizes of our own, level by level from the roots.
void refineByCriteria(OctreeBuilder& builder, const RefinementCriteria& criteria, OctreeBudget& budget,
                      Monitor& monitor) {
  std::vector<Id> batch(builder.size());
  std::iota(batch.begin(), batch.end(), 0);
  for (int level = 0; level < builder.brick().maxLevel && !batch.empty(); ++level) {
    monitor.check(0.8 * level / builder.brick().maxLevel, "refinement");
    const RefinementCriteria::Choice choice = criteria.select(builder, batch);
    const Id firstChild = builder.size();
    budget.check(builder, choice, level);
    builder.split(choice.leaves);
    tbb::parallel_for(std::size_t(0), choice.leaves.size(),
                      [&](std::size_t i) { builder.explain(choice.leaves[i], choice.causes[i]); });
    batch.resize(builder.size() - firstChild);
    std::iota(batch.begin(), batch.end(), firstChild);
  }
}

// Criterion 8: a cell the surface does not touch, beside a smaller one that it does, becomes as small, so
// that the front follows the surface in cells of one size.
std::vector<Id> besideSmallerCut(const OctreeBuilder& builder, int cells) {
  tbb::enumerable_thread_specific<std::vector<Id>> found;
  tbb::parallel_for(Id(0), builder.size(), [&](Id i) {
    const auto& n = builder.node(i);
    if (!n.isLeaf() || !n.isCut()) return;
    for (int z = -cells; z <= cells; ++z)
      for (int y = -cells; y <= cells; ++y)
        for (int x = -cells; x <= cells; ++x) {
          const Id other = builder.neighbour(n, {x, y, z});
          if (other == kNone) continue;
          const auto& m = builder.node(other);
          if (m.isLeaf() && !m.isCut() && m.level < n.level) found.local().push_back(other);
        }
  });
  std::vector<Id> chosen;
  for (const auto& mine : found) chosen.insert(chosen.end(), mine.begin(), mine.end());
  tbb::parallel_sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace

Octree decompose(const SurfaceModel& model, const OctreeDecomposeOptions& options, Monitor& monitor) {
  checkOptions(model, options);
  monitor.check(0, "localisation");
  OctreeBuilder builder(chooseBrick(model, options), model);
  const RefinementCriteria criteria(model, builder.brick(), options, monitor);
  OctreeBudget budget(options, builder.brick());
  refineByCriteria(builder, criteria, budget, monitor);
  for (;;) {
    monitor.check(0.85, "balancing");
    builder.balance(options.cellsBetweenLevels);
    const std::vector<Id> beside = besideSmallerCut(builder, options.bufferCells);
    if (beside.empty()) break;
    budget.check(builder, beside.size());
    builder.split(beside);
    for (Id leaf : beside) builder.explain(leaf, {RefineReason::SmallerCut, 0, -1});
  }
  monitor.check(0.95, "collecting leaves");
  return std::move(builder).finish();
}

}  // namespace pm
