// SPDX-License-Identifier: BSD-3-Clause
#include "Octree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

// Spreads the low 21 bits of x to every third bit.
Key spread(Key x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

std::int32_t gather(Key x) {
  x &= 0x1249249249249249ull;
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

void Octree::index() {
  const Key last = keys.empty() ? 0 : keys.back();
  int bits = 1;
  while (bits < 63 && (last >> bits) != 0) ++bits;
  int want = 1;  // about one bucket a leaf
  while (want < 26 && (Id(1) << want) < size()) ++want;
  shift_ = std::max(0, bits - want);
  bucket_.assign((last >> shift_) + 2, size());
  for (Id leaf = size(); leaf-- > 0;) bucket_[keys[leaf] >> shift_] = leaf;
  for (std::size_t b = bucket_.size() - 1; b-- > 0;) bucket_[b] = std::min(bucket_[b], bucket_[b + 1]);
}

Id Octree::find(const Coord& c) const {
  if (!brick.inside(c)) return kNone;
  const Key key = encode(c);
  const Key block = std::min<Key>(key >> shift_, bucket_.size() - 2);
  // The covering leaf is the last whose key is not above ours.
  const auto first = keys.begin() + bucket_[block];
  const auto last = keys.begin() + bucket_[block + 1];
  const Id leaf = static_cast<Id>(std::upper_bound(first, last, key) - keys.begin()) - 1;
  if (leaf < 0) return kNone;
  const Key covered = Key(1) << (3 * (brick.maxLevel - levels[leaf]));
  return key - keys[leaf] < covered ? leaf : kNone;
}

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
  const int axis = side / 2, level = levels[leaf];
  const std::int32_t span = brick.span(level);
  Coord c = corner(leaf);
  c[axis] += side % 2 ? span : -1;
  const Id first = find(c);
  if (first == kNone) return 0;
  out[0] = first;
  if (levels[first] <= level) return 1;
  const std::int32_t half = span / 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int k = 1; k < 4; ++k) {
    Coord d = c;
    d[u] += (k & 1) ? half : 0;
    d[v] += (k & 2) ? half : 0;
    out[k] = find(d);
  }
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

}  // namespace pm
