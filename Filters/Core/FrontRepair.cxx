// SPDX-License-Identifier: BSD-3-Clause
#include "FrontRepair.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

// An addition may only be undone once, so after this many rounds only removals go on; they must come to an
// end.
constexpr int kGrowingRounds = 12;

}  // namespace

FrontRepair::FrontRepair(const Octree& tree, const SurfaceModel& model, std::vector<std::uint8_t>& painted,
                         std::vector<Id>& regionOf)
    : tree_(tree),
      model_(model),
      painted_(painted),
      regionOf_(regionOf),
      touched_(painted.size(), 0),
      gainChanged_(painted.size(), 0) {}

// A domain side mirrors, so that the front meets it at right angles.
Key FrontRepair::axisKey(std::int32_t x, int axis) const {
  Coord c{0, 0, 0};
  c[axis] = std::clamp(x, 0, tree_.brick.extent(axis) - 1);
  return encode(c);
}

std::array<Id, 8> FrontRepair::leavesAround(const Coord& node) const {
  Key keys[3][2];
  for (int a = 0; a < 3; ++a)
    for (int k = 0; k < 2; ++k) keys[a][k] = axisKey(node[a] + k - 1, a);
  std::array<Id, 8> leaves;
  for (int k = 0; k < 8; ++k)
    leaves[k] = tree_.covering(keys[0][k & 1] | keys[1][k >> 1 & 1] | keys[2][k >> 2]);
  return leaves;
}

FrontRepair::Surroundings FrontRepair::surroundings(Id leaf) const {
  const std::int32_t span = tree_.brick.span(tree_.levels[leaf]);
  Surroundings s;
  s.steps = span > 1 ? 2 : 1;  // smaller neighbours may have nodes half way along the edges and faces
  s.corner = tree_.corner(leaf);
  s.step = span / s.steps;
  Key keys[3][4];
  for (int a = 0; a < 3; ++a) {
    keys[a][0] = axisKey(s.corner[a] - 1, a);
    for (int i = 1; i <= s.steps + 1; ++i) keys[a][i] = axisKey(s.corner[a] + (i - 1) * s.step, a);
  }
  const auto inside = [&](int i) { return i >= 1 && i <= s.steps; };
  for (int z = 0; z <= s.steps + 1; ++z)
    for (int y = 0; y <= s.steps + 1; ++y)
      for (int x = 0; x <= s.steps + 1; ++x)
        s.leaves[x + 4 * y + 16 * z] =
            inside(x) && inside(y) && inside(z) ? leaf : tree_.covering(keys[0][x] | keys[1][y] | keys[2][z]);
  return s;
}

bool FrontRepair::forbidden(const Coord& node, const std::array<Id, 8>& leaves, Id flipped) const {
  unsigned pattern = 0;
  bool isNode = false;
  const std::int32_t bits = node[0] | node[1] | node[2];
  for (int k = 0; k < 8; ++k) {
    if ((painted_[leaves[k]] != 0) == (leaves[k] == flipped)) continue;
    pattern |= 1u << k;
    isNode = isNode || (bits & (tree_.brick.span(tree_.levels[leaves[k]]) - 1)) == 0;
  }
  return isNode && pattern != 255 && !isPermittedPattern(pattern);
}

bool FrontRepair::isFront(Id leaf) const {
  if (!painted_[leaf]) return false;
  std::array<Id, 4> n;
  for (int side = 0; side < 6; ++side)
    for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;)
      if (!painted_[n[k]]) return true;
  return false;
}

std::vector<Key> FrontRepair::cornersOfFront(const std::vector<Id>& leaves) const {
  tbb::enumerable_thread_specific<std::vector<Key>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 1024), [&](const auto& range) {
    std::vector<Key>& mine = found.local();
    const std::size_t before = mine.size();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      if (!isFront(leaves[i])) continue;
      const Coord corner = tree_.corner(leaves[i]);
      const std::int32_t span = tree_.brick.span(tree_.levels[leaves[i]]);
      for (int k = 0; k < 8; ++k)
        mine.push_back(encode(
            {corner[0] + (k & 1) * span, corner[1] + (k >> 1 & 1) * span, corner[2] + (k >> 2) * span}));
    }
    // Consecutive leaves share most of their corners.
    std::sort(mine.begin() + before, mine.end());
    mine.erase(std::unique(mine.begin() + before, mine.end()), mine.end());
  });
  std::vector<Key> keys;
  for (const auto& mine : found) keys.insert(keys.end(), mine.begin(), mine.end());
  tbb::parallel_sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

std::vector<Coord> FrontRepair::forbiddenNodes(const std::vector<Id>& leaves) const {
  const std::vector<Key> keys = cornersOfFront(leaves);
  std::vector<std::uint8_t> bad(keys.size());
  tbb::parallel_for(std::size_t(0), keys.size(), [&](std::size_t i) {
    const Coord node = decode(keys[i]);
    bad[i] = forbidden(node, leavesAround(node), kNone);
  });
  std::vector<Coord> nodes;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (bad[i]) nodes.push_back(decode(keys[i]));
  return nodes;
}

int FrontRepair::forbiddenOn(const Surroundings& s, Id flipped) const {
  int count = 0;
  std::array<Id, 8> leaves;
  for (int z = 0; z <= s.steps; ++z)
    for (int y = 0; y <= s.steps; ++y)
      for (int x = 0; x <= s.steps; ++x) {
        if (s.steps == 2 && x == 1 && y == 1 && z == 1) continue;
        for (int k = 0; k < 8; ++k)
          leaves[k] = s.leaves[x + (k & 1) + 4 * (y + (k >> 1 & 1)) + 16 * (z + (k >> 2))];
        const Coord node{s.corner[0] + x * s.step, s.corner[1] + y * s.step, s.corner[2] + z * s.step};
        count += forbidden(node, leaves, flipped);
      }
  return count;
}

int FrontRepair::gain(Id leaf) const {
  const Surroundings s = surroundings(leaf);
  return forbiddenOn(s, kNone) - forbiddenOn(s, leaf);
}

bool FrontRepair::inSight(Id from, Id to) const {
  return !model_.crosses(tree_.box(from).centre(), tree_.box(to).centre());
}

// A painted neighbour out of sight is on the other side of a wall: adding the leaf would make a way through.
bool FrontRepair::seesPaintedNeighbours(Id leaf) const {
  std::array<Id, 4> n;
  bool any = false;
  for (int side = 0; side < 6; ++side)
    for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;) {
      if (!painted_[n[k]]) continue;
      if (!inSight(n[k], leaf)) return false;
      any = true;
    }
  return any;
}

Id FrontRepair::regionBeside(Id leaf) const {
  std::array<Id, 4> n;
  Id region = kNone;
  for (int side = 0; side < 6; ++side)
    for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;) {
      if (!painted_[n[k]]) continue;
      if (region != kNone && regionOf_[n[k]] != region) return kNone;
      region = regionOf_[n[k]];
    }
  return region;
}

void FrontRepair::add(Id leaf, Id region) {
  painted_[leaf] = 1;
  regionOf_[leaf] = region;
}

bool FrontRepair::isBetweenPainted(Id leaf) const {
  std::array<Id, 4> lower, upper;
  const auto paintedInSight = [&](Id n) { return painted_[n] && inSight(n, leaf); };
  for (int axis = 0; axis < 3; ++axis) {
    const int nl = tree_.faceNeighbours(leaf, 2 * axis, lower);
    const int nu = tree_.faceNeighbours(leaf, 2 * axis + 1, upper);
    if (std::any_of(lower.begin(), lower.begin() + nl, paintedInSight) &&
        std::any_of(upper.begin(), upper.begin() + nu, paintedInSight))
      return true;
  }
  return false;
}

Id FrontRepair::fill() {
  std::vector<Id> candidates;
  for (Id leaf = 0; leaf < tree_.size(); ++leaf)
    if (!painted_[leaf] && tree_.cut[leaf] && !touched_[leaf]) candidates.push_back(leaf);
  // Gains are foreseen for all candidates at once; those beside a cell painted meanwhile are taken again.
  constexpr int kNotBetween = -1000;
  std::vector<std::int16_t> foreseen(candidates.size());
  tbb::parallel_for(std::size_t(0), candidates.size(), [&](std::size_t i) {
    foreseen[i] =
        static_cast<std::int16_t>(isBetweenPainted(candidates[i]) ? gain(candidates[i]) : kNotBetween);
  });
  std::vector<Id> filled;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Id leaf = candidates[i];
    if (foreseen[i] == kNotBetween || (gainChanged_[leaf] ? gain(leaf) : foreseen[i]) < 0) continue;
    const Id region = regionBeside(leaf);
    if (region == kNone || !seesPaintedNeighbours(leaf)) continue;
    add(leaf, region);
    filled.push_back(leaf);
    forSurroundings(leaf, [&](Id other) { gainChanged_[other] = 1; });
  }
  for (Id leaf : filled) forSurroundings(leaf, [&](Id other) { gainChanged_[other] = 0; });
  return static_cast<Id>(filled.size());
}

/// Part of a leaf's edge that its centre is away from the geometry, below 1.
double FrontRepair::roominess(Id leaf) const {
  const double edge = tree_.brick.edge(tree_.levels[leaf]);
  return std::min(0.9, std::sqrt(model_.closest(tree_.box(leaf).centre()).distance2) / edge);
}

// A cell that mends no node on balance is added, too: it moves a forbidden node to the next cell of a row, at
// whose end the node is gone. To remove cells instead tears the front where the domain is two or three cells
// thick. Of equal gains the cell farthest inside is taken.
bool FrontRepair::growAt(const Coord& node) {
  Id best = kNone;
  double bestScore = 0;
  for (Id leaf : leavesAround(node)) {
    if (painted_[leaf] || !tree_.cut[leaf] || touched_[leaf] || leaf == best) continue;
    const int g = gain(leaf);
    if (g + 1 <= bestScore) continue;
    const double score = g + roominess(leaf);
    if (score > bestScore && regionBeside(leaf) != kNone && seesPaintedNeighbours(leaf)) {
      best = leaf;
      bestScore = score;
    }
  }
  if (best == kNone) return false;
  add(best, regionBeside(best));
  markChanged(best);
  return true;
}

bool FrontRepair::removeAt(const Coord& node) {
  Id best = kNone;
  double bestScore = 0;
  for (Id leaf : leavesAround(node)) {
    if (!painted_[leaf] || leaf == best) continue;
    // Among equal gains the smaller cell goes: it takes less of the domain with it.
    const double score = gain(leaf) + 0.01 * tree_.levels[leaf];
    if (best == kNone || score > bestScore) {
      best = leaf;
      bestScore = score;
    }
  }
  if (best == kNone) return false;
  painted_[best] = 0;
  markChanged(best);
  return true;
}

void FrontRepair::markChanged(Id leaf) {
  touched_[leaf] = 1;
  changed_.push_back(leaf);
}

// A changed leaf changes the patterns of the nodes on its surface, and which of its face neighbours are
// front.
std::vector<Id> FrontRepair::aroundChanged() const {
  std::vector<Id> leaves;
  for (Id leaf : changed_) forSurroundings(leaf, [&](Id other) { leaves.push_back(other); });
  sortUnique(leaves);
  return leaves;
}

void FrontRepair::clean(Monitor& monitor, PaintFrontReport& report) {
  std::vector<Id> leaves(tree_.size());
  std::iota(leaves.begin(), leaves.end(), 0);
  for (int round = 0;; ++round) {
    monitor.check(0.5 + 0.3 * round / (round + 5.0), "front repair");
    const std::vector<Coord> nodes = forbiddenNodes(leaves);
    if (nodes.empty()) return;
    changed_.clear();
    for (const Coord& node : nodes) {
      if (!forbidden(node, leavesAround(node), kNone)) continue;  // an earlier change mended it
      if (round < kGrowingRounds && growAt(node))
        ++report.grown;
      else if (removeAt(node))
        ++report.removed;
    }
    leaves = aroundChanged();
  }
}

}  // namespace pm
