// SPDX-License-Identifier: BSD-3-Clause
#include "RefinementCriteria.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "OctreeBrick.h"
#include "TriangleBox.h"

namespace pm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// A cell with more triangles than this is judged by an even sample of them; it either splits for its normals
// or is looked at again, with fewer triangles, one level down.
constexpr std::size_t kSample = 24;

// Normals that differ by less belong to one side of a feature when criteria 1 and 2 give no angle.
constexpr double kSideAngle = 40;

}  // namespace

/// An even sample of a cell's triangles.
struct RefinementCriteria::Sample {
  std::size_t count = 0;
  std::array<Id, kSample> triangle;
  std::array<Vec3, kSample> normal, centre;  // signs aligned with the first; centres of the cut figures
};

RefinementCriteria::RefinementCriteria(const SurfaceModel& model, const Brick& brick,
                                       const OctreeDecomposeOptions& options, Monitor& monitor)
    : model_(model),
      options_(options),
      brick_(brick),
      features_(model, options, brick.edge(brick.maxLevel), monitor),
      sizes_(model, options),
      probe_(model, brick, options),
      patchSize_(model.patchNames().size(), 0.0),
      finest_(brick.edge(brick.maxLevel)),
      cosNormal_(std::cos(options.normalAngle * kDegree)),
      cosHalfNormal_(std::cos(0.5 * options.normalAngle * kDegree)),
      sinClose_(std::sin(options.closeAngle * kDegree)),
      cosClose_(std::cos(options.closeAngle * kDegree)),
      cosSide_(std::cos((options.normalAngle > 0 ? options.normalAngle : kSideAngle) * kDegree)) {
  for (std::size_t p = 0; p < patchSize_.size(); ++p)
    for (const auto& [name, size] : options.patchSizes)
      if (name == model.patchNames()[p]) patchSize_[p] = size;
}

// Criterion 9: sizes the user gave for the surface, patches and parts of space.
RefineCause RefinementCriteria::sizeAsksFor(const OctreeBuilder& builder, const Node& n) const {
  const double edge = brick_.edge(n.level) * (1 - 1e-6);
  const auto because = [&](RefineCause cause, double size) {
    cause.level = static_cast<std::uint8_t>(levelFor(brick_, size));
    return cause;
  };
  if (!sizes_.empty()) {
    double limit = 0;
    const RefineCause cause = sizes_.asks(builder.box(n), edge, limit);
    if (cause.reason != RefineReason::Root) return because(cause, limit);
  }
  if (!n.isCut()) return {};
  if (options_.surfaceSize > 0 && edge > options_.surfaceSize)
    return because({RefineReason::SurfaceSize, 0, narrowPatch(patchIn(builder, n))}, options_.surfaceSize);
  if (!options_.patchSizes.empty())
    for (Id t : builder.triangles(n)) {
      const double limit = patchSize_[model_.patchOf(t)];
      if (limit > 0 && edge > limit)
        return because({RefineReason::PatchSize, 0, narrowPatch(model_.patchOf(t))}, limit);
    }
  return {};
}

// Separating criterion (Fig. 3-19): two pieces of surface face each other when the line between them leaves
// the plane of either by more than closeAngle. Pieces nearer than half the finest cell cannot be separated by
// any.
bool RefinementCriteria::facing(const Vec3& normalA, const Vec3& normalB, const Vec3& between) const {
  const double d = between.norm();
  if (d < 0.5 * finest_) return false;
  return std::abs(normalA.dot(between)) > sinClose_ * d || std::abs(normalB.dot(between)) > sinClose_ * d;
}

// The centres of the pieces of two large triangles in a coarse cell may lie farther apart along the surfaces
// than across the gap between them, and then the line between them says nothing (thesis Fig. 3-19 has no such
// pair). What faces a point for certain is what its normal meets in the cell.
bool RefinementCriteria::opposite(const Vec3& from, const Vec3& normal, Id triangle, const Box& cell) const {
  const double cosine = std::abs(normal.dot(model_.normal(triangle)));
  const Vec3& a = model_.corner(triangle, 0);
  if (cosine < cosClose_ || std::abs(model_.normal(triangle).dot(a - from)) < 0.5 * finest_ * cosine)
    return false;
  const double t = rayHit(from, normal, a, model_.corner(triangle, 1), model_.corner(triangle, 2));
  return std::isfinite(t) && cell.contains(from + t * normal);
}

bool RefinementCriteria::facing(const Sample& sample, std::size_t i, std::size_t j, const Box& cell) const {
  return facing(sample.normal[i], sample.normal[j], sample.centre[j] - sample.centre[i]) ||
         opposite(sample.centre[i], sample.normal[i], sample.triangle[j], cell) ||
         opposite(sample.centre[j], sample.normal[j], sample.triangle[i], cell);
}

RefineCause RefinementCriteria::look(const OctreeBuilder& builder, const Node& n, Summary& s,
                                     Sides* sides) const {
  const Box box = builder.box(n);
  using Answer = FeatureDemand::Answer;
  const FeatureDemand::Demand demand = features_.at(box);
  if (sides) sides->feature = demand.answer != Answer::None;
  if (demand.answer == Answer::Split || demand.answer == Answer::Near) {
    const bool full = options_.featureDepth == FeatureDepth::Full;
    const auto level = static_cast<std::uint8_t>(full ? brick_.maxLevel : 0);
    const auto patch = narrowPatch(patchIn(builder, n));
    return {demand.answer == Answer::Split ? RefineReason::Feature : RefineReason::FeatureBuffer, level,
            patch};
  }
  const Span<Id> list = builder.triangles(n);
  Sample sample;
  sample.count = std::min(list.size(), kSample);
  for (std::size_t i = 0; i < sample.count; ++i) {
    const Id t = list[i * list.size() / sample.count];
    sample.triangle[i] = t;
    sample.normal[i] = model_.normal(t);
    if (sample.normal[i].dot(sample.normal[0]) < 0) sample.normal[i] = -sample.normal[i];
    sample.centre[i] = cutCentre(box, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2));
  }
  const RefineCause cause = lookAtSurface(sample, box, s);
  return sides && demand.answer == Answer::Keep ? lookAtSides(sample, box, demand.sides, *sides) : cause;
}

// Criterion 7 for cells the surface does not cut; one layer of them comes with criterion 8.
RefineCause RefinementCriteria::besideFeature(const Box& cell) const {
  if (options_.featureBuffer < 2 || options_.featureDepth != FeatureDepth::Full) return {};
  if (features_.at(cell).answer == FeatureDemand::Answer::None) return {};
  return {RefineReason::FeatureBuffer, static_cast<std::uint8_t>(brick_.maxLevel), -1};
}

// Criteria 1 and 3 for the whole cell.
RefineCause RefinementCriteria::lookAtSurface(const Sample& sample, const Box& cell, Summary& s) const {
  const std::size_t count = sample.count;
  for (std::size_t i = 0; i < count; ++i) {
    s.normal += sample.normal[i];
    s.centre += sample.centre[i];
  }
  s.centre /= double(count);
  if (s.normal.norm() > 0) s.normal.normalize();
  s.samples = static_cast<int>(std::min<std::size_t>(count, Summary::kSample));
  for (int i = 0; i < s.samples; ++i) s.sample[i] = sample.triangle[i * count / s.samples];
  // A spread of normalAngle is half of it to either side of the mean.
  if (options_.normalAngle > 0 && options_.cellNormals)
    for (std::size_t i = 0; i < count; ++i)
      if (std::abs(sample.normal[i].dot(s.normal)) < cosHalfNormal_)
        return because(RefineReason::CellNormals, sample.triangle[i]);
  if (options_.separate && options_.cellSeparation)
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (facing(sample, i, j, cell)) return because(RefineReason::CellFacing, sample.triangle[i]);
  return {};
}

// Criteria 1 and 3 where a feature explains that the normals differ: the triangles fall into as many smooth
// sides as meet at the feature, and no side faces itself.
RefineCause RefinementCriteria::lookAtSides(const Sample& sample, const Box& cell, int most,
                                            Sides& sides) const {
  std::array<Vec3, Sides::kMost> first, centre;
  std::array<int, Sides::kMost> members{};
  std::array<int, kSample> side{};
  for (std::size_t i = 0; i < sample.count; ++i) {
    int k = 0;
    while (k < sides.count && std::abs(sample.normal[i].dot(first[k])) < cosSide_) ++k;
    if (k == sides.count) {
      if (k == Sides::kMost || (k >= most && options_.cellNormals && options_.normalAngle > 0))
        return because(RefineReason::CellNormals, sample.triangle[i]);
      first[sides.count++] = sample.normal[i];
      centre[k] = Vec3::Zero();
    }
    side[i] = k;
    ++members[k];
    centre[k] += sample.centre[i];
  }
  if (options_.separate && options_.cellSeparation)
    for (std::size_t i = 0; i < sample.count; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (side[i] == side[j] && facing(sample, i, j, cell))
          return because(RefineReason::CellFacing, sample.triangle[i]);
  for (int k = 0; k < sides.count; ++k) {
    sides.normal[k] = first[k].cast<float>();
    sides.centre[k] = (centre[k] / members[k] - brick_.origin).cast<float>();
  }
  return {};
}

// Gaps and curvature. A gap also marks the free cells across it.
void RefinementCriteria::probe(Level& level) const {
  if (probe_.measuresCurvature())
    tbb::parallel_for(std::size_t(0), level.batch.size(), [&](std::size_t i) {
      if (level.row[i] == kNone || level.cause[i].reason != RefineReason::Root) return;
      const Node& n = level.builder.node(level.batch[i]);
      if (probe_.bends(level.builder, n))
        level.cause[i] = {RefineReason::Curvature, 0, narrowPatch(patchIn(level.builder, n))};
    });
  if (!probe_.measuresGaps()) return;
  tbb::enumerable_thread_specific<std::vector<SurfaceProbe::Mark>> found;
  tbb::parallel_for(std::size_t(0), level.batch.size(), [&](std::size_t i) {
    if (level.row[i] != kNone)
      probe_.gap(level.builder, level.builder.node(level.batch[i]), level.batch[i], found.local());
  });
  std::vector<SurfaceProbe::Mark> marks;
  for (const auto& mine : found) marks.insert(marks.end(), mine.begin(), mine.end());
  tbb::parallel_sort(marks.begin(), marks.end());
  for (const SurfaceProbe::Mark& mark : marks) {  // the smallest patch comes first
    RefineCause& cause = level.cause[level.place(mark.node)];
    if (cause.reason == RefineReason::Root) cause = {RefineReason::Gap, 0, narrowPatch(mark.patch)};
  }
}

RefinementCriteria::Choice RefinementCriteria::select(const OctreeBuilder& builder,
                                                      const std::vector<Id>& batch) const {
  // The batch is a run of consecutive nodes, so a node's place in it follows from its index.
  Level level{builder, batch, {}, std::vector<Id>(batch.size(), kNone), {}, {}};
  level.cause.resize(batch.size());
  Id cut = 0;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (builder.node(batch[i]).isCut()) level.row[i] = cut++;
  level.summary.resize(cut);
  if (options_.featureDepth == FeatureDepth::AsNeeded) level.sides.resize(cut);
  tbb::parallel_for(std::size_t(0), batch.size(), [&](std::size_t i) {
    const Node& n = builder.node(batch[i]);
    level.cause[i] = sizeAsksFor(builder, n);
    const Id row = level.row[i];
    if (level.cause[i].reason != RefineReason::Root) return;
    if (row == kNone)
      level.cause[i] = besideFeature(builder.box(n));
    else
      level.cause[i] =
          look(builder, n, level.summary[row], level.sides.empty() ? nullptr : &level.sides[row]);
  });
  probe(level);
  compareNeighbours(level);
  fillIslands(level);
  evenCurves(level);
  Choice choice;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (level.cause[i].reason != RefineReason::Root) {
      choice.leaves.push_back(batch[i]);
      choice.causes.push_back(level.cause[i]);
    }
  return choice;
}

}  // namespace pm
