// SPDX-License-Identifier: BSD-3-Clause
#include "FrontRepair.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace pm {
namespace {

// Does the open segment p-q cross the triangle? Touching counts: doubt means "not in sight".
bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 d = q - p, ab = b - a, ac = c - a, n = ab.cross(ac);
  const double denominator = -d.dot(n);
  const double scale = d.norm() * n.norm();
  if (std::abs(denominator) <= 1e-12 * scale) return false;  // parallel: seen edge-on
  const Vec3 ap = p - a;
  const double t = ap.dot(n) / denominator;
  if (t < 0 || t > 1) return false;
  const Vec3 e = -d.cross(ap);
  const double v = ac.dot(e) / denominator, w = -ab.dot(e) / denominator;
  constexpr double kRim = -1e-9;
  return v >= kRim && w >= kRim && v + w <= 1 - kRim;
}

// An addition may only be undone once, so after this many rounds only removals go on; they must come to an
// end.
constexpr int kGrowingRounds = 12;

}  // namespace

FrontRepair::FrontRepair(const Octree& tree, const SurfaceModel& model, std::vector<std::uint8_t>& painted)
    : tree_(tree), model_(model), painted_(painted), touched_(painted.size(), 0) {}

// Leaves in the eight octants around a node; a domain side mirrors, so that the front meets it at right
// angles.
std::array<Id, 8> FrontRepair::leavesAround(const Coord& node) const {
  std::array<Id, 8> leaves;
  for (int k = 0; k < 8; ++k) {
    Coord c = node;
    for (int a = 0; a < 3; ++a) {
      if (!(k >> a & 1)) --c[a];
      if (c[a] < 0) c[a] = 0;
      if (c[a] >= tree_.brick.extent(a)) c[a] = tree_.brick.extent(a) - 1;
    }
    leaves[k] = tree_.find(c);
  }
  return leaves;
}

bool FrontRepair::forbidden(const Coord& node) const {
  const std::array<Id, 8> leaves = leavesAround(node);
  unsigned pattern = 0;
  bool isNode = false;
  for (int k = 0; k < 8; ++k) {
    if (!painted_[leaves[k]]) continue;
    pattern |= 1u << k;
    const std::int32_t span = tree_.brick.span(tree_.levels[leaves[k]]);
    isNode = isNode || (node[0] % span == 0 && node[1] % span == 0 && node[2] % span == 0);
  }
  return isNode && pattern != 255 && !isPermittedPattern(pattern);
}

std::vector<Coord> FrontRepair::forbiddenNodes() const {
  tbb::enumerable_thread_specific<std::vector<Key>> found;
  tbb::parallel_for(Id(0), tree_.size(), [&](Id leaf) {
    if (!painted_[leaf]) return;
    bool front = false;
    std::array<Id, 4> n;
    for (int side = 0; side < 6 && !front; ++side)
      for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;) front = front || !painted_[n[k]];
    if (!front) return;
    const std::int32_t span = tree_.brick.span(tree_.levels[leaf]);
    for (int k = 0; k < 8; ++k) {
      Coord c = tree_.corner(leaf);
      for (int a = 0; a < 3; ++a) c[a] += (k >> a & 1) * span;
      if (forbidden(c)) found.local().push_back(encode(c));
    }
  });
  std::vector<Key> keys;
  for (const auto& mine : found) keys.insert(keys.end(), mine.begin(), mine.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<Coord> nodes;
  for (Key k : keys) nodes.push_back(decode(k));
  return nodes;
}

int FrontRepair::forbiddenOn(Id leaf) const {
  const std::int32_t span = tree_.brick.span(tree_.levels[leaf]);
  const Coord c = tree_.corner(leaf);
  // Smaller neighbours may have nodes half way along the edges and faces.
  const int steps = span > 1 ? 2 : 1, step = span / steps;
  int count = 0;
  for (int z = 0; z <= steps; ++z)
    for (int y = 0; y <= steps; ++y)
      for (int x = 0; x <= steps; ++x) {
        if (steps == 2 && x == 1 && y == 1 && z == 1) continue;
        count += forbidden({c[0] + x * step, c[1] + y * step, c[2] + z * step});
      }
  return count;
}

int FrontRepair::gain(Id leaf) {
  const int before = forbiddenOn(leaf);
  painted_[leaf] ^= 1;
  const int after = forbiddenOn(leaf);
  painted_[leaf] ^= 1;
  return before - after;
}

bool FrontRepair::inSight(Id from, Id to) const {
  const Vec3 p = tree_.box(from).centre(), q = tree_.box(to).centre();
  Box path;
  path.add(p);
  path.add(q);
  for (Id t : model_.trianglesNear(path))
    if (crosses(p, q, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2))) return false;
  return true;
}

bool FrontRepair::hasPaintedNeighbourInSight(Id leaf) const {
  std::array<Id, 4> n;
  for (int side = 0; side < 6; ++side)
    for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;)
      if (painted_[n[k]] && inSight(n[k], leaf)) return true;
  return false;
}

Id FrontRepair::fill() {
  std::vector<Id> candidates;
  for (Id leaf = 0; leaf < tree_.size(); ++leaf)
    if (!painted_[leaf] && tree_.cut[leaf] && !touched_[leaf]) candidates.push_back(leaf);
  std::vector<std::uint8_t> between(candidates.size(), 0);
  tbb::parallel_for(std::size_t(0), candidates.size(), [&](std::size_t i) {
    std::array<Id, 4> lower, upper;
    for (int axis = 0; axis < 3 && !between[i]; ++axis) {
      const int nl = tree_.faceNeighbours(candidates[i], 2 * axis, lower);
      const int nu = tree_.faceNeighbours(candidates[i], 2 * axis + 1, upper);
      const auto paintedInSight = [&](Id n) { return painted_[n] && inSight(n, candidates[i]); };
      between[i] = std::any_of(lower.begin(), lower.begin() + nl, paintedInSight) &&
                   std::any_of(upper.begin(), upper.begin() + nu, paintedInSight);
    }
  });
  Id count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (between[i] && gain(candidates[i]) >= 0) {
      painted_[candidates[i]] = 1;
      ++count;
    }
  return count;
}

bool FrontRepair::growAt(const Coord& node) {
  Id best = kNone;
  int bestGain = 0;
  for (Id leaf : leavesAround(node)) {
    if (painted_[leaf] || !tree_.cut[leaf] || touched_[leaf] || leaf == best) continue;
    const int g = gain(leaf);
    if (g > bestGain && hasPaintedNeighbourInSight(leaf)) {
      best = leaf;
      bestGain = g;
    }
  }
  if (best == kNone) return false;
  painted_[best] = 1;
  touched_[best] = 1;
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
  touched_[best] = 1;
  return true;
}

void FrontRepair::clean(Monitor& monitor, PaintFrontReport& report) {
  for (int round = 0;; ++round) {
    monitor.check(0.5 + 0.3 * round / (round + 5.0), "front repair");
    const std::vector<Coord> nodes = forbiddenNodes();
    if (nodes.empty()) return;
    for (const Coord& node : nodes) {
      if (!forbidden(node)) continue;  // an earlier change mended it
      if (round < kGrowingRounds && growAt(node))
        ++report.grown;
      else if (removeAt(node))
        ++report.removed;
    }
  }
}

}  // namespace pm
