// SPDX-License-Identifier: BSD-3-Clause
#include "RefinementCriteria.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "TriangleBox.h"

namespace pm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// A cell with more triangles than this is judged by an even sample of them; it either splits for its normals
// or is looked at again, with fewer triangles, one level down.
constexpr std::size_t kSample = 24;

FeatureOptions featureOptions(const OctreeDecomposeOptions& o, double finest) {
  FeatureOptions f;
  f.sharpAngle = o.sharpAngle;
  f.gapTolerance = 0.5 * finest;
  return f;
}

}  // namespace

RefinementCriteria::RefinementCriteria(const SurfaceModel& model, const Brick& brick,
                                       const OctreeDecomposeOptions& options)
    : model_(model),
      options_(options),
      features_(detectFeatures(model, featureOptions(options, brick.edge(brick.maxLevel)))),
      patchSize_(model.patchNames().size(), 0.0),
      finest_(brick.edge(brick.maxLevel)),
      cosNormal_(std::cos(options.normalAngle * kDegree)),
      cosHalfNormal_(std::cos(0.5 * options.normalAngle * kDegree)),
      sinClose_(std::sin(options.closeAngle * kDegree)) {
  for (std::size_t p = 0; p < patchSize_.size(); ++p)
    for (const auto& [name, size] : options.patchSizes)
      if (name == model.patchNames()[p]) patchSize_[p] = size;
}

// Criterion 9: sizes the user gave for the surface, patches and boxes.
bool RefinementCriteria::sizeAsksFor(const OctreeBuilder& builder, const OctreeBuilder::Node& n) const {
  const double edge = builder.brick().edge(n.level) * (1 - 1e-6);
  const Box box = builder.box(n);
  for (const RefineBox& r : options_.boxes)
    if (edge > r.size && r.box.overlaps(box)) return true;
  if (!n.isCut()) return false;
  if (options_.surfaceSize > 0 && edge > options_.surfaceSize) return true;
  if (!options_.patchSizes.empty())
    for (Id t : builder.triangles(n)) {
      const double limit = patchSize_[model_.patchOf(t)];
      if (limit > 0 && edge > limit) return true;
    }
  return false;
}

// Criteria 5 and 7: a feature in the cell, or within one finest cell of it, so that the front has fine cells
// to either side of the feature's own.
bool RefinementCriteria::featureInside(Box box) const {
  box.lo.array() -= finest_;
  box.hi.array() += finest_;
  for (Id s : features_.segmentsNear(box)) {
    const FeatureSegment& segment = features_.segments()[s];
    if (touches(box, segment.a, segment.b)) return true;
  }
  return false;
}

// Separating criterion (Fig. 3-19): two pieces of surface face each other when the line between them leaves
// the plane of either by more than closeAngle. Pieces nearer than half the finest cell cannot be separated by
// any.
bool RefinementCriteria::facing(const Vec3& normalA, const Vec3& normalB, const Vec3& between) const {
  const double d = between.norm();
  if (d < 0.5 * finest_) return false;
  return std::abs(normalA.dot(between)) > sinClose_ * d || std::abs(normalB.dot(between)) > sinClose_ * d;
}

RefinementCriteria::Summary RefinementCriteria::look(const OctreeBuilder& builder,
                                                     const OctreeBuilder::Node& n) const {
  Summary s;
  s.cut = n.isCut();
  if (sizeAsksFor(builder, n)) s.split = true;
  if (s.split || !s.cut) return s;
  const Box box = builder.box(n);
  if (options_.refineEdges && featureInside(box)) s.split = true;
  if (s.split) return s;

  const Span<Id> list = builder.triangles(n);
  const std::size_t count = std::min(list.size(), kSample);
  std::array<Vec3, kSample> normal, centre;
  for (std::size_t i = 0; i < count; ++i) {
    const Id t = list[i * list.size() / count];
    normal[i] = model_.normal(t);
    if (normal[i].dot(normal[0]) < 0) normal[i] = -normal[i];
    s.normal += normal[i];
    centre[i] = cutCentre(box, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2));
    s.centre += centre[i];
  }
  s.centre /= double(count);
  if (s.normal.norm() > 0) s.normal.normalize();
  s.normalCount = static_cast<int>(std::min<std::size_t>(count, Summary::kNormals));
  for (int i = 0; i < s.normalCount; ++i) s.normals[i] = normal[i * count / s.normalCount];
  // Criterion 1: a spread of normalAngle is half of it to either side of the mean.
  if (options_.normalAngle > 0)
    for (std::size_t i = 0; i < count && !s.split; ++i)
      s.split = std::abs(normal[i].dot(s.normal)) < cosHalfNormal_;
  // Criterion 3.
  if (options_.separate)
    for (std::size_t i = 0; i < count && !s.split; ++i)
      for (std::size_t j = 0; j < i && !s.split; ++j)
        s.split = facing(normal[i], normal[j], centre[j] - centre[i]);
  return s;
}

// Criteria 2 and 4 for two adjacent cells, each with a single piece of surface (else they would split by 1 or
// 3).
bool RefinementCriteria::disagree(const Summary& a, const Summary& b) const {
  if (options_.normalAngle > 0)
    for (int i = 0; i < a.normalCount; ++i)
      for (int j = 0; j < b.normalCount; ++j)
        if (std::abs(a.normals[i].dot(b.normals[j])) < cosNormal_) return true;
  return options_.separate && facing(a.normal, b.normal, b.centre - a.centre);
}

/// Calls body(place in the batch, or kNone for a coarser leaf) for each cut cell around batch[i].
template <class Body>
static void forCutNeighbours(const OctreeBuilder& builder, const std::vector<Id>& batch, std::size_t i,
                             const Body& body) {
  const auto& n = builder.node(batch[i]);
  for (int k = 0; k < 27; ++k) {
    const Id other = k == 13 ? kNone : builder.neighbour(n, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1});
    if (other != kNone && builder.node(other).isCut())
      body(builder.node(other).level == n.level ? other - batch.front() : kNone);
  }
}

// A cell on the surface more than two fifths of whose neighbours on it will be split is split as well: coarse
// islands and ragged borders in a fine front are what the projection cannot straighten. A straight border
// stays where it is (three of eight neighbours); from a corner it would creep on, so there are only a few
// rounds.
void RefinementCriteria::fillIslands(const OctreeBuilder& builder, const std::vector<Id>& batch,
                                     std::vector<std::uint8_t>& split) {
  std::vector<std::uint8_t> around(batch.size(), 0), finer(batch.size(), 0);
  const auto asks = [&](std::size_t i) { return !split[i] && 5 * finer[i] > 2 * around[i]; };
  tbb::parallel_for(std::size_t(0), batch.size(), [&](std::size_t i) {
    if (split[i] || !builder.node(batch[i]).isCut()) return;
    forCutNeighbours(builder, batch, i, [&](Id place) {
      ++around[i];
      finer[i] += place != kNone && split[place];
    });
  });
  constexpr int kRounds = 3;
  std::vector<std::size_t> asking;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (asks(i)) asking.push_back(i);
  for (int round = 0; round < kRounds && !asking.empty(); ++round) {
    for (std::size_t i : asking) split[i] = 1;
    std::vector<std::size_t> next;
    for (std::size_t i : asking)
      forCutNeighbours(builder, batch, i, [&](Id place) {
        if (place == kNone || split[place]) return;
        ++finer[place];
        next.push_back(place);
      });
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    asking.clear();
    std::copy_if(next.begin(), next.end(), std::back_inserter(asking), asks);
  }
}

std::vector<Id> RefinementCriteria::select(const OctreeBuilder& builder, const std::vector<Id>& batch) const {
  std::vector<Summary> summary(batch.size());
  tbb::parallel_for(std::size_t(0), batch.size(),
                    [&](std::size_t i) { summary[i] = look(builder, builder.node(batch[i])); });
  // The batch is a run of consecutive nodes, so a node's place in it follows from its index.
  const Id first = batch.empty() ? 0 : batch.front();
  std::vector<std::uint8_t> split(batch.size(), 0);
  tbb::parallel_for(std::size_t(0), batch.size(), [&](std::size_t i) {
    split[i] = summary[i].split;
    if (split[i] || !summary[i].cut) return;
    const auto& n = builder.node(batch[i]);
    for (int k = 0; k < 27 && !split[i]; ++k) {
      const Id other = k == 13 ? kNone : builder.neighbour(n, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1});
      if (other == kNone || builder.node(other).level != n.level) continue;
      const Summary& s = summary[other - first];
      split[i] = s.cut && !s.split && disagree(summary[i], s);
    }
  });
  fillIslands(builder, batch, split);
  std::vector<Id> chosen;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (split[i]) chosen.push_back(batch[i]);
  return chosen;
}

}  // namespace pm
