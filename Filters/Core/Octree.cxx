// SPDX-License-Identifier: BSD-3-Clause
#include "Octree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "SurfaceModel.h"
#include "TriangleBox.h"

namespace pm {
namespace {

constexpr Key kAxisBits = 0x1249249249249249ull;  // the bits of the first axis

// Spreads the low 21 bits of x to every third bit.
Key spread(Key x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & kAxisBits;
}

std::int32_t gather(Key x) {
  x &= kAxisBits;
  x = (x ^ (x >> 2)) & 0x10c30c30c30c30c3ull;
  x = (x ^ (x >> 4)) & 0x100f00f00f00f00full;
  x = (x ^ (x >> 8)) & 0x1f0000ff0000ffull;
  x = (x ^ (x >> 16)) & 0x1f00000000ffffull;
  return static_cast<std::int32_t>((x ^ (x >> 32)) & 0x1fffff);
}

template <class Predicate>
bool allLeaves(const Octree& tree, const Predicate& holds) {
  return tbb::parallel_reduce(
      tbb::blocked_range<Id>(0, tree.size()), true,
      [&](const tbb::blocked_range<Id>& r, bool ok) {
        for (Id leaf = r.begin(); ok && leaf < r.end(); ++leaf) ok = holds(leaf);
        return ok;
      },
      [](bool a, bool b) { return a && b; });
}

}  // namespace

Key encode(const Coord& c) { return spread(Key(c[0])) | spread(Key(c[1])) << 1 | spread(Key(c[2])) << 2; }

Coord decode(Key key) { return {gather(key), gather(key >> 1), gather(key >> 2)}; }

Vec3 Brick::position(const Coord& c) const {
  const double finest = 1.0 / double(std::int64_t(1) << maxLevel);
  return {origin[0] + rootSize[0] * (c[0] * finest), origin[1] + rootSize[1] * (c[1] * finest),
          origin[2] + rootSize[2] * (c[2] * finest)};
}

Box Brick::box(Key key, int level) const {
  Coord c = decode(key);
  const Vec3 lo = position(c);
  for (auto& x : c) x += span(level);
  return {lo, position(c)};
}

bool Brick::inside(const Coord& c) const {
  for (int a = 0; a < 3; ++a)
    if (c[a] < 0 || c[a] >= extent(a)) return false;
  return true;
}

double touchSlack(const Brick& brick, int level) {
  Coord end;
  for (int a = 0; a < 3; ++a) end[a] = brick.extent(a);
  const double far = brick.origin.cwiseAbs().cwiseMax(brick.position(end).cwiseAbs()).maxCoeff();
  return std::max(1e-9 * brick.edge(level), 8 * std::numeric_limits<double>::epsilon() * far);
}

void Octree::index() { index_.build(keys); }

Id Octree::covering(Key key) const {
  const Id leaf = index_.upperBound(keys, key) - 1;
  if (leaf < 0) return kNone;
  const Key covered = Key(1) << (3 * (brick.maxLevel - levels[leaf]));
  return key - keys[leaf] < covered ? leaf : kNone;
}

Id Octree::find(const Coord& c) const { return brick.inside(c) ? covering(encode(c)) : kNone; }

Id Octree::locate(const Vec3& p) const {
  Coord c;
  for (int a = 0; a < 3; ++a) {
    const double x = (p[a] - brick.origin[a]) / brick.rootSize[a];
    if (!(x >= 0 && x <= brick.roots[a])) return kNone;
    c[a] = std::min(static_cast<std::int32_t>(x * double(1 << brick.maxLevel)), brick.extent(a) - 1);
  }
  return find(c);
}

int Octree::faceNeighbours(Id leaf, int side, std::array<Id, 4>& out) const {
  // Keys are added and compared axis by axis as they are: the bits of an axis with ones between them carry
  // like a plain number.
  const int axis = side / 2, level = levels[leaf];
  const Key mask = kAxisBits << axis, mine = keys[leaf] & mask, others = keys[leaf] & ~mask;
  const Key span = Key(1) << (3 * (brick.maxLevel - level) + axis);
  Key beside;
  if (side % 2) {
    beside = ((mine | ~mask) + span) & mask;
    if (beside >= spread(brick.extent(axis)) << axis) return 0;
  } else {
    if (mine == 0) return 0;
    beside = (mine - (Key(1) << axis)) & mask;
  }
  const Id first = covering(others | beside);
  if (first == kNone) return 0;
  out[0] = first;
  if (levels[first] <= level) return 1;
  // The half edge's bit is clear in both other axes of a leaf's key.
  const int up = 3 * (brick.maxLevel - level - 1);
  const Key u = Key(1) << (up + (axis + 1) % 3), v = Key(1) << (up + (axis + 2) % 3);
  for (int k = 1; k < 4; ++k) out[k] = covering(others | beside | ((k & 1) ? u : 0) | ((k & 2) ? v : 0));
  return 4;
}

bool isComplete(const Octree& tree) {
  if (tree.size() == 0) return false;
  double volume = 0;  // in root cells; exact, because every term is a power of 1/8
  for (Id leaf = 0; leaf < tree.size(); ++leaf) volume += std::ldexp(1.0, -3 * tree.levels[leaf]);
  const auto& r = tree.brick.roots;
  if (volume != double(r[0]) * r[1] * r[2]) return false;
  return allLeaves(tree, [&](Id leaf) {
    const Key covered = Key(1) << (3 * (tree.brick.maxLevel - tree.levels[leaf]));
    return tree.keys[leaf] % covered == 0 && tree.brick.inside(tree.corner(leaf)) &&
           (leaf + 1 == tree.size() || tree.keys[leaf] + covered <= tree.keys[leaf + 1]);
  });
}

bool isBalanced(const Octree& tree) {
  return allLeaves(tree, [&](Id leaf) {
    const Coord c = tree.corner(leaf);
    const std::int32_t span = tree.brick.span(tree.levels[leaf]);
    for (int n = 0; n < 27; ++n) {
      if (n == 13) continue;
      const int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      Coord q;
      for (int a = 0; a < 3; ++a) q[a] = d[a] < 0 ? c[a] - 1 : d[a] > 0 ? c[a] + span : c[a];
      const Id other = tree.find(q);
      // Looking from the smaller leaf to the larger finds every pair.
      if (other != kNone && tree.levels[leaf] - tree.levels[other] > 1) return false;
    }
    return true;
  });
}

bool findsAllTriangles(const Octree& tree, const SurfaceModel& model) {
  if (tree.triangles.rows() != tree.size()) return false;
  const auto touchesLeaf = [&](const Box& box, Id t, double slack) {
    return touches(box, model.corner(t, 0), model.corner(t, 1), model.corner(t, 2), slack);
  };
  return allLeaves(tree, [&](Id leaf) {
    const Span<Id> list = tree.triangles[leaf];
    if (list.empty() == (tree.cut[leaf] != 0)) return false;
    for (std::size_t i = 1; i < list.size(); ++i)
      if (list[i - 1] >= list[i]) return false;
    const Box box = tree.box(leaf);
    // Lists come from the parent's slack, and a little more for what the two tests round differently.
    const double slack = 4 * touchSlack(tree.brick, std::max(0, tree.levels[leaf] - 1));
    for (Id t : list)
      if (!touchesLeaf(box, t, slack)) return false;
    for (Id t : model.trianglesNear(box))
      if (touchesLeaf(box, t, 0) && !std::binary_search(list.begin(), list.end(), t)) return false;
    return true;
  });
}

}  // namespace pm
