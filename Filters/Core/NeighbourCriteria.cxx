// SPDX-License-Identifier: BSD-3-Clause
// The criteria that compare cells with others (RefinementCriteria.h): 2 and 4 with their neighbours, the
// filling of islands, and the evening out along critical edges.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "RefinementCriteria.h"

namespace pm {
namespace {

/// Asks the surface itself, or does the user give a size for a part of it?
bool isOfTheSurface(RefineReason reason) {
  switch (reason) {
    case RefineReason::CellNormals:
    case RefineReason::Normals:
    case RefineReason::CellFacing:
    case RefineReason::Facing:
    case RefineReason::Feature:
    case RefineReason::FeatureBuffer:
    case RefineReason::Island:
      return true;
    default:
      return false;
  }
}

/// Calls body(node) for each cut cell around n, until it says stop.
template <class Body>
void forCutNeighbours(const OctreeBuilder& builder, const OctreeBuilder::Node& n, const Body& body) {
  for (int k = 0; k < 27; ++k) {
    const Id other = k == 13 ? kNone : builder.neighbour(n, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1});
    if (other != kNone && builder.node(other).isCut() && body(other)) return;
  }
}

}  // namespace

// Criteria 2 and 4 for two adjacent cells, each with a single piece of surface (else they would split by 1 or
// 3).
RefineReason RefinementCriteria::disagree(const Level& level, std::size_t i, std::size_t j) const {
  if (!level.sides.empty() && (level.sides[level.row[i]].count > 0 || level.sides[level.row[j]].count > 0))
    return sidesDisagree(level, i, j);
  const Summary &a = level.summary[level.row[i]], &b = level.summary[level.row[j]];
  if (options_.normalAngle > 0 && options_.neighbourNormals)
    for (int k = 0; k < a.samples; ++k)
      for (int l = 0; l < b.samples; ++l)
        if (std::abs(model_.normal(a.sample[k]).dot(model_.normal(b.sample[l]))) < cosNormal_ &&
            !featureBetween(level, i, j))
          return RefineReason::Normals;
  const bool separate = options_.separate && options_.neighbourSeparation;
  if (separate && facing(a.normal, b.normal, b.centre - a.centre) &&
      (std::abs(a.normal.dot(b.normal)) >= cosSide_ || !featureBetween(level, i, j)))
    return RefineReason::Facing;
  if (separate && std::abs(a.normal.dot(b.normal)) >= cosClose_) {
    const Box beyond = level.builder.box(level.builder.node(level.batch[j]));
    for (int l = 0; l < b.samples; ++l)
      if (opposite(a.centre, a.normal, b.sample[l], beyond)) return RefineReason::Facing;
  }
  return RefineReason::Root;
}

// The same where at least one of the cells holds a feature: each smooth side of the cell with fewer sides
// goes on in one of the other.
RefineReason RefinementCriteria::sidesDisagree(const Level& level, std::size_t i, std::size_t j) const {
  const auto sidesOf = [&](std::size_t cell) {
    Sides s = level.sides[level.row[cell]];
    if (s.count > 0) return s;
    const Summary& summary = level.summary[level.row[cell]];
    s.count = 1;
    s.normal[0] = summary.normal.cast<float>();
    s.centre[0] = (summary.centre - brick_.origin).cast<float>();
    return s;
  };
  Sides a = sidesOf(i), b = sidesOf(j);
  if (a.count > b.count) std::swap(a, b);
  for (int k = 0; k < a.count; ++k) {
    bool matched = false;
    for (int l = 0; l < b.count; ++l) {
      if (std::abs(a.normal[k].dot(b.normal[l])) < cosSide_) continue;
      matched = true;
      const Vec3 between = (b.centre[l] - a.centre[k]).cast<double>();
      if (options_.separate && options_.neighbourSeparation &&
          facing(a.normal[k].cast<double>(), b.normal[l].cast<double>(), between))
        return RefineReason::Facing;
    }
    if (!matched && options_.normalAngle > 0 && options_.neighbourNormals && !featureBetween(level, i, j))
      return RefineReason::Normals;
  }
  return RefineReason::Root;
}

// Two cells on either side of a feature that runs through a third one beside both.
bool RefinementCriteria::featureBetween(const Level& level, std::size_t i, std::size_t j) const {
  if (level.sides.empty()) return false;
  const Node &a = level.builder.node(level.batch[i]), &b = level.builder.node(level.batch[j]);
  const Coord far = decode(b.key);
  bool found = level.sides[level.row[i]].feature && level.sides[level.row[j]].feature;
  forCutNeighbours(level.builder, a, [&](Id node) {
    const Node& c = level.builder.node(node);
    if (c.level != a.level) return found;
    const Coord at = decode(c.key);
    bool beside = true;
    for (int axis = 0; axis < 3; ++axis)
      beside = beside && std::abs(at[axis] - far[axis]) <= brick_.span(a.level);
    found = found || (beside && level.sides[level.row[level.place(node)]].feature);
    return found;
  });
  return found;
}

void RefinementCriteria::compareNeighbours(Level& level) const {
  std::vector<RefineReason> reason(level.batch.size(), RefineReason::Root);
  const auto open = [&](std::size_t i) {
    return level.row[i] != kNone && level.cause[i].reason == RefineReason::Root;
  };
  tbb::parallel_for(std::size_t(0), level.batch.size(), [&](std::size_t i) {
    if (!open(i)) return;
    const Node& n = level.builder.node(level.batch[i]);
    forCutNeighbours(level.builder, n, [&](Id other) {
      const std::size_t j = level.place(other);
      if (level.builder.node(other).level == n.level && open(j)) reason[i] = disagree(level, i, j);
      return reason[i] != RefineReason::Root;
    });
  });
  tbb::parallel_for(std::size_t(0), level.batch.size(), [&](std::size_t i) {
    if (reason[i] == RefineReason::Root) return;
    level.cause[i] = {reason[i], 0, narrowPatch(patchIn(level.builder, level.builder.node(level.batch[i])))};
  });
}

// A cell on the surface more than two fifths of whose neighbours on it will be split is split as well: coarse
// islands and ragged borders in a fine front are what the projection cannot straighten. A straight border
// stays where it is (three of eight neighbours); from a corner it would creep on, so there are only a few
// rounds.
void RefinementCriteria::fillIslands(Level& level) {
  const OctreeBuilder& builder = level.builder;
  const std::size_t size = level.batch.size();
  std::vector<std::uint8_t> around(size, 0), finer(size, 0);
  const auto split = [&](std::size_t i) { return level.cause[i].reason != RefineReason::Root; };
  const auto asks = [&](std::size_t i) { return !split(i) && 5 * finer[i] > 2 * around[i]; };
  /// body(place in the batch, or kNone for a coarser leaf)
  const auto forPlaces = [&](std::size_t i, const auto& body) {
    const Node& n = builder.node(level.batch[i]);
    forCutNeighbours(builder, n, [&](Id other) {
      body(builder.node(other).level == n.level ? level.place(other) : kNone);
      return false;
    });
  };
  tbb::parallel_for(std::size_t(0), size, [&](std::size_t i) {
    if (split(i) || level.row[i] == kNone) return;
    forPlaces(i, [&](Id place) {
      ++around[i];
      finer[i] += place != kNone && split(place);
    });
  });
  constexpr int kRounds = 3;
  std::vector<std::size_t> asking;
  for (std::size_t i = 0; i < size; ++i)
    if (asks(i)) asking.push_back(i);
  for (int round = 0; round < kRounds && !asking.empty(); ++round) {
    for (std::size_t i : asking) level.cause[i].reason = RefineReason::Island;
    std::vector<std::size_t> next;
    for (std::size_t i : asking)
      forPlaces(i, [&](Id place) {
        if (place == kNone || split(place)) return;
        ++finer[place];
        next.push_back(place);
      });
    sortUnique(next);
    asking.clear();
    std::copy_if(next.begin(), next.end(), std::back_inserter(asking), asks);
  }
}

// As needed, the cells along a critical edge and beside it are all as small as those where the surface asks
// for the smallest. Where they change their size the front has a trench across the edge, as deep as the
// larger ones, and the wall there may find no nodes for the edge. An edge of more cells saves more than it
// loses by changing its size.
void RefinementCriteria::evenCurves(Level& level) const {
  constexpr double kMostCells = 48;
  if (level.sides.empty() || features_.graph().curves().empty()) return;
  std::vector<std::atomic<bool>> asks(features_.graph().curves().size());
  const auto forCurves = [&](const auto& counts, const auto& body) {
    tbb::parallel_for(std::size_t(0), level.batch.size(), [&](std::size_t i) {
      if (level.row[i] == kNone || !counts(level.cause[i].reason)) return;
      const Box cell = level.builder.box(level.builder.node(level.batch[i]));
      for (Id c : features_.curvesNear(cell, kMostCells * cell.size().maxCoeff())) body(i, c);
    });
  };
  forCurves(isOfTheSurface, [&](std::size_t, Id c) { asks[c].store(true, std::memory_order_relaxed); });
  forCurves([](RefineReason reason) { return reason == RefineReason::Root; },
            [&](std::size_t i, Id c) {
              if (!asks[c].load(std::memory_order_relaxed)) return;
              const Node& n = level.builder.node(level.batch[i]);
              level.cause[i] = {RefineReason::FeatureBuffer, 0, narrowPatch(patchIn(level.builder, n))};
            });
}

}  // namespace pm
