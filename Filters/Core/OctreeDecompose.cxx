// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeDecompose.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "OctreeBuilder.h"
#include "RefinementCriteria.h"

namespace pm {
namespace {

double effectiveFeatureSize(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  return o.featureSize > 0 ? o.featureSize : model.bounds().diagonal() / 50;
}

void checkOptions(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  const Box& b = model.bounds();
  if (!(b.diagonal() > 0)) throw InputError("The geometry has no extent: all its points coincide.");
  if (!std::isfinite(o.featureSize) || o.featureSize < 0)
    throw InputError(fmt::format("The feature size must be a positive length, not {}.", o.featureSize));
  if (o.featureSize > b.size().maxCoeff())
    throw InputError(
        fmt::format("The feature size {:g} is larger than the geometry ({:g} x {:g} x {:g}); choose a "
                    "smaller one, or check the units.",
                    o.featureSize, b.size()[0], b.size()[1], b.size()[2]));
  if (!std::isfinite(o.baseSize) || o.baseSize < 0)
    throw InputError(fmt::format("The base size must be a positive length, not {}.", o.baseSize));
  if (o.baseSize > 0 && o.maxLevel < 0 && o.baseSize < effectiveFeatureSize(model, o))
    throw InputError(
        fmt::format("The base size {:g} is smaller than the feature size {:g}; make it at least as large.",
                    o.baseSize, effectiveFeatureSize(model, o)));
  if (o.useDomain) {
    if (!o.domain.lo.allFinite() || !o.domain.hi.allFinite() || !(o.domain.size().array() > 0).all())
      throw InputError("The domain's bounds must be finite, and each minimum below its maximum.");
    if (!o.domain.overlaps(b))
      throw InputError("The geometry lies outside the given domain; check bounds and units.");
  }
  if (o.cellsBetweenLevels < 1 || o.bufferCells < 0)
    throw InputError("Cells between levels must be at least 1, and buffer cells at least 0.");
  for (const RefineBox& r : o.boxes)
    if (r.box.empty() || !(r.size > 0))
      throw InputError("A refinement box needs minima below its maxima and a positive cell size.");
  for (const auto& [name, size] : o.patchSizes) {
    const auto& names = model.patchNames();
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError("There is no patch named '" + name + "' in the geometry to give a cell size.");
    if (!(size > 0)) throw InputError("The cell size on patch '" + name + "' must be positive.");
  }
}

int levelFor(double rootEdge, double size) {
  // A hair of tolerance: a root of 1 and a size of 1/32 is level 5 whatever the rounding of the quotient.
  return std::max(0, static_cast<int>(std::ceil(std::log2(rootEdge / size) - 1e-6)));
}

Brick chooseBrick(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  const double feature = effectiveFeatureSize(model, o);
  const Box extent = o.useDomain ? o.domain : model.bounds();
  const Vec3 size = extent.size();
  double base = o.baseSize;
  if (!(base > 0)) {
    // The largest feature * 2^k that keeps a few root cells along the longest side: coarse far from the
    // geometry, and the finest cell is the feature size exactly.
    base = o.maxLevel >= 0 ? size.maxCoeff() / 4 : feature;
    if (o.maxLevel < 0)
      while (2 * base <= size.maxCoeff() / 4) base *= 2;
  }
  Brick brick;
  double cells = 1;
  for (int a = 0; a < 3; ++a) {
    const double wanted =
        o.useDomain ? std::max(1.0, std::round(size[a] / base)) : std::ceil(size[a] / base) + 2 * o.margin;
    if (!(wanted < double(1 << kCoordBits)))
      throw InputError(
          fmt::format("A base size of {:g} divides the domain into too many root cells; enlarge it.", base));
    brick.roots[a] = std::max(1, static_cast<int>(std::ceil(wanted)));
    brick.rootSize[a] = o.useDomain ? size[a] / brick.roots[a] : base;
    cells *= brick.roots[a];
  }
  if (cells > double(o.maxCells))
    throw BudgetError(
        fmt::format("A base size of {:g} already gives {:g} root cells, more than the {} allowed; enlarge "
                    "it or raise the limit.",
                    base, cells, o.maxCells));
  const Vec3 whole = brick.rootSize.cwiseProduct(Vec3(brick.roots[0], brick.roots[1], brick.roots[2]));
  brick.origin = o.useDomain ? extent.lo : Vec3(extent.centre() - 0.5 * whole);
  brick.sidesArePatches = o.useDomain;
  brick.maxLevel = o.maxLevel >= 0 ? o.maxLevel : levelFor(brick.rootSize.maxCoeff(), feature);
  const int most = *std::max_element(brick.roots.begin(), brick.roots.end());
  if (brick.maxLevel > kMaxLevel ||
      (std::int64_t(most) << brick.maxLevel) > (std::int64_t(1) << kCoordBits) - 1)
    throw InputError(
        fmt::format("The feature size {:g} is too small for a domain of {:g}: at most 2^{} cells fit along "
                    "a side.",
                    feature, whole.maxCoeff(), kCoordBits));
  return brick;
}

void splitWithinBudget(OctreeBuilder& builder, const std::vector<Id>& leaves,
                       const OctreeDecomposeOptions& o) {
  const std::int64_t after = builder.leafCount() + 7 * static_cast<std::int64_t>(leaves.size());
  if (after > o.maxCells)
    throw BudgetError(
        fmt::format("The octree would need more than {} cells (about {} GB); use a larger feature size, "
                    "or raise the limit on cells.",
                    o.maxCells, 1 + after * 1000 / 1000000000));
  builder.split(leaves);
}

// Pass 1: criteria 1-5 and 9, level by level from the roots.
void refineByCriteria(OctreeBuilder& builder, const RefinementCriteria& criteria,
                      const OctreeDecomposeOptions& o, Monitor& monitor) {
  std::vector<Id> batch(builder.size());
  std::iota(batch.begin(), batch.end(), 0);
  for (int level = 0; level < builder.brick().maxLevel && !batch.empty(); ++level) {
    monitor.check(0.8 * level / builder.brick().maxLevel, "refinement");
    const std::vector<Id> chosen = criteria.select(builder, batch);
    const Id firstChild = builder.size();
    splitWithinBudget(builder, chosen, o);
    batch.resize(builder.size() - firstChild);
    std::iota(batch.begin(), batch.end(), firstChild);
  }
}

// Criteria 7, 8: a cell the surface does not touch, beside a smaller one that it does, becomes as small, so
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
  const RefinementCriteria criteria(model, builder.brick(), options);
  refineByCriteria(builder, criteria, options, monitor);
  for (;;) {
    monitor.check(0.85, "balancing");
    builder.balance(options.cellsBetweenLevels);
    const std::vector<Id> beside = besideSmallerCut(builder, options.bufferCells);
    if (beside.empty()) break;
    splitWithinBudget(builder, beside, options);
  }
  monitor.check(0.95, "collecting leaves");
  return builder.finish();
}

}  // namespace pm
