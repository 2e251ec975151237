// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeBuilder.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "TriangleBox.h"

namespace pm {
namespace {
// A triangle that misses a cell by less than this part of the cell's edge still counts as touching it, so
// that rounding never opens a hole in a surface that lies on cell faces.
constexpr double kTouchSlack = 1e-9;
}  // namespace

OctreeBuilder::OctreeBuilder(const Brick& brick, const SurfaceModel& model) : model_(model), brick_(brick) {
  const auto& r = brick.roots;
  for (std::int32_t z = 0; z < r[2]; ++z)
    for (std::int32_t y = 0; y < r[1]; ++y)
      for (std::int32_t x = 0; x < r[0]; ++x) {
        Node n;
        const int shift = brick.maxLevel;
        n.key = encode({x << shift, y << shift, z << shift});
        nodes_.push_back(n);
      }
  leafCount_ = size();
  std::vector<std::vector<Id>> lists(nodes_.size());
  tbb::parallel_for(Id(0), size(), [&](Id i) {
    Box b = box(nodes_[i]);
    const double slack = kTouchSlack * brick_.edge(0);
    b.lo.array() -= slack;
    b.hi.array() += slack;
    for (Id t : model_.trianglesNear(b))
      if (touches(b, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2), 0)) lists[i].push_back(t);
  });
  for (Id i = 0; i < size(); ++i) {
    nodes_[i].firstTriangle = static_cast<std::uint32_t>(pool_.size());
    nodes_[i].triangles = static_cast<std::uint32_t>(lists[i].size());
    pool_.insert(pool_.end(), lists[i].begin(), lists[i].end());
  }
}

Id OctreeBuilder::find(const Coord& c, int level) const {
  if (!brick_.inside(c)) return kNone;
  const int shift = brick_.maxLevel;
  Id i = (c[0] >> shift) + brick_.roots[0] * ((c[1] >> shift) + brick_.roots[1] * (c[2] >> shift));
  for (int l = 1; l <= level && !nodes_[i].isLeaf(); ++l) {
    const int bit = shift - l;
    i = nodes_[i].firstChild + (((c[0] >> bit) & 1) | ((c[1] >> bit) & 1) << 1 | ((c[2] >> bit) & 1) << 2);
  }
  return i;
}

Id OctreeBuilder::neighbour(const Node& n, const Coord& d) const {
  Coord c = decode(n.key);
  const std::int32_t span = brick_.span(n.level);
  for (int a = 0; a < 3; ++a) c[a] += d[a] * span;
  return find(c, n.level);
}

void OctreeBuilder::split(const std::vector<Id>& leaves) {
  const std::size_t firstNew = nodes_.size();
  nodes_.resize(firstNew + 8 * leaves.size());
  leafCount_ += 7 * static_cast<std::int64_t>(leaves.size());
  // One byte a (leaf, triangle) pair tells which children the triangle touches; counting, summing and filling
  // follow.
  std::vector<std::size_t> start(leaves.size() + 1, 0);
  for (std::size_t i = 0; i < leaves.size(); ++i) start[i + 1] = start[i] + nodes_[leaves[i]].triangles;
  std::vector<std::uint8_t> touched(start.back());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    Node& parent = nodes_[leaves[i]];
    parent.firstChild = static_cast<Id>(firstNew + 8 * i);
    const double slack = kTouchSlack * brick_.edge(parent.level);
    Box boxes[8];
    for (int k = 0; k < 8; ++k) {
      Node& child = nodes_[parent.firstChild + k];
      child.level = parent.level + 1;
      child.key = parent.key + (Key(k) << (3 * (brick_.maxLevel - child.level)));
      boxes[k] = box(child);
    }
    const Span<Id> list = triangles(parent);
    for (std::size_t j = 0; j < list.size(); ++j) {
      const Vec3 &a = model_.corner(list[j], 0), &b = model_.corner(list[j], 1),
                 &c = model_.corner(list[j], 2);
      std::uint8_t bits = 0;
      for (int k = 0; k < 8; ++k)
        if (touches(boxes[k], a, b, c, slack)) {
          bits |= std::uint8_t(1) << k;
          ++nodes_[parent.firstChild + k].triangles;
        }
      touched[start[i] + j] = bits;
    }
  });
  std::size_t end = pool_.size();
  for (std::size_t n = firstNew; n < nodes_.size(); ++n) {
    nodes_[n].firstTriangle = static_cast<std::uint32_t>(end);
    end += nodes_[n].triangles;
  }
  if (end > std::numeric_limits<std::uint32_t>::max())
    throw BudgetError(
        "The octree would hold more than 4 billion triangle references; use a larger feature size.");
  pool_.resize(end);
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    const Node& parent = nodes_[leaves[i]];
    std::uint32_t next[8];
    for (int k = 0; k < 8; ++k) next[k] = nodes_[parent.firstChild + k].firstTriangle;
    const Span<Id> list = triangles(parent);
    for (std::size_t j = 0; j < list.size(); ++j)
      for (int k = 0; k < 8; ++k)
        if (touched[start[i] + j] >> k & 1) pool_[next[k]++] = list[j];
  });
}

OctreeBuilder::Grading OctreeBuilder::tooCoarse(const std::vector<Id>& changed, int cells) const {
  tbb::enumerable_thread_specific<Grading> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, changed.size(), 64), [&](const auto& range) {
    Grading& mine = found.local();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Node& n = nodes_[changed[i]];
      if (n.level == 0) continue;
      // Cells of n's level exist where their parents are split, so the parents within reach are looked at.
      const int up = brick_.maxLevel - n.level + 1, own = up - 1;
      const Coord c = decode(n.key);
      Coord lo, hi;
      for (int a = 0; a < 3; ++a) {
        lo[a] = ((c[a] >> own) - cells) >> 1;
        hi[a] = ((c[a] >> own) + cells) >> 1;
      }
      bool again = false;
      for (int z = lo[2]; z <= hi[2]; ++z)
        for (int y = lo[1]; y <= hi[1]; ++y)
          for (int x = lo[0]; x <= hi[0]; ++x) {
            const Id parent = find({x * (1 << up), y * (1 << up), z * (1 << up)}, n.level - 1);
            if (parent == kNone || !nodes_[parent].isLeaf()) continue;
            mine.leaves.push_back(parent);
            again = again || nodes_[parent].level + 1 < n.level;
          }
      if (again) mine.unsettled.push_back(changed[i]);
    }
  });
  Grading all;
  for (const Grading& mine : found) {
    all.leaves.insert(all.leaves.end(), mine.leaves.begin(), mine.leaves.end());
    all.unsettled.insert(all.unsettled.end(), mine.unsettled.begin(), mine.unsettled.end());
  }
  for (auto* list : {&all.leaves, &all.unsettled}) {
    tbb::parallel_sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  return all;
}

void OctreeBuilder::balance(int cells) {
  std::vector<Id> changed;
  for (Id i = 0; i < size(); ++i)
    if (!nodes_[i].isLeaf()) changed.push_back(i);
  for (;;) {
    const Grading grading = tooCoarse(changed, cells);
    if (grading.leaves.empty()) return;
    split(grading.leaves);
    changed = grading.unsettled;
    changed.insert(changed.end(), grading.leaves.begin(), grading.leaves.end());
  }
}

Octree OctreeBuilder::finish() const {
  Octree tree;
  tree.brick = brick_;
  std::vector<std::pair<Key, Id>> leaves;
  leaves.reserve(leafCount_);
  for (Id i = 0; i < size(); ++i)
    if (nodes_[i].isLeaf()) leaves.emplace_back(nodes_[i].key, i);
  tbb::parallel_sort(leaves.begin(), leaves.end());
  const std::size_t n = leaves.size();
  tree.keys.resize(n);
  tree.levels.resize(n);
  tree.cut.resize(n);
  tree.triangles.offsets.resize(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const Node& leaf = nodes_[leaves[i].second];
    tree.keys[i] = leaf.key;
    tree.levels[i] = leaf.level;
    tree.cut[i] = leaf.isCut();
    tree.triangles.offsets[i + 1] = tree.triangles.offsets[i] + static_cast<Id>(leaf.triangles);
  }
  tree.triangles.values.resize(tree.triangles.offsets[n]);
  tbb::parallel_for(std::size_t(0), n, [&](std::size_t i) {
    const Span<Id> list = triangles(nodes_[leaves[i].second]);
    std::copy(list.begin(), list.end(), tree.triangles.values.begin() + tree.triangles.offsets[i]);
  });
  tree.index();
  return tree;
}

}  // namespace pm
