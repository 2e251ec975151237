// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeBrick.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

double effectiveFeatureSize(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  return o.featureSize > 0 ? o.featureSize : model.bounds().diagonal() / 50;
}

bool isSize(double size) { return size > 0 && std::isfinite(size); }

void checkShapes(const OctreeDecomposeOptions& o) {
  for (const RefineBox& r : o.boxes)
    if (r.box.empty() || !(r.size > 0))
      throw InputError("A refinement box needs minima below its maxima and a positive cell size.");
  for (const RefineSphere& r : o.spheres)
    if (!r.centre.allFinite() || !isSize(r.radius) || !isSize(r.size))
      throw InputError(fmt::format(
          "A refinement sphere needs a finite centre, a positive radius and a positive cell size; "
          "the radius is {:g} and the size {:g}.",
          r.radius, r.size));
  for (const RefineCylinder& r : o.cylinders)
    if (!r.start.allFinite() || !r.end.allFinite() || !((r.end - r.start).norm() > 0) || !isSize(r.radius) ||
        !isSize(r.size))
      throw InputError(
          fmt::format("A refinement cylinder needs two different ends of its axis, a positive radius and a "
                      "positive cell size; the radius is {:g} and the size {:g}.",
                      r.radius, r.size));
  for (const SurfaceDistance& r : o.surfaceDistances)
    if (!(r.distance >= 0) || !isSize(r.size))
      throw InputError(
          fmt::format("A distance from the size surface must be 0 or more and its cell size positive, not "
                      "{:g} and {:g}.",
                      r.distance, r.size));
  if (!o.surfaceDistances.empty() && !o.sizeSurface)
    throw InputError("There are distances from the size surface, but no size surface; connect one.");
}

void checkPatches(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  const auto& names = model.patchNames();
  const auto check = [&](const std::string& name, double distance, double size) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError("There is no patch named '" + name + "' in the geometry to give a cell size.");
    if (!(size > 0)) throw InputError("The cell size on patch '" + name + "' must be positive.");
    if (!(distance >= 0)) throw InputError("The distance from patch '" + name + "' must be 0 or more.");
  };
  for (const auto& [name, size] : o.patchSizes) check(name, 0, size);
  for (const PatchDistance& row : o.patchDistances) check(row.patch, row.distance, row.size);
}

}  // namespace

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
  if (o.cellsBetweenLevels < 1 || o.bufferCells < 0 || o.featureBuffer < 0)
    throw InputError(
        "Cells between levels must be at least 1, buffer cells and the feature buffer at least 0.");
  if (o.gapCells < 0 || o.cellsPerCircle < 0)
    throw InputError("Gap cells and cells per circle must be at least 0, which turns them off.");
  if (!(o.maxMemory >= 0))
    throw InputError(fmt::format("The most memory must be 0 or more GB, not {}.", o.maxMemory));
  checkShapes(o);
  checkPatches(model, o);
}

int levelFor(double rootEdge, double size) {
  // A hair of tolerance: a root of 1 and a size of 1/32 is level 5 whatever the rounding of the quotient.
  return std::max(0, static_cast<int>(std::ceil(std::log2(rootEdge / size) - 1e-6)));
}

int levelFor(const Brick& brick, double size) {
  return std::min(brick.maxLevel, levelFor(brick.edge(0), size));
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

}  // namespace pm
