// SPDX-License-Identifier: BSD-3-Clause
#include "Bvh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

constexpr int kBins = 16;
constexpr Id kHalvingSize = 32;     // below this a plain halving is as good as a weighed split
constexpr Id kParallelSize = 8192;  // subtrees smaller than this are built by one task

Id leavesFor(Id items) { return (items + Bvh::kLeafSize - 1) / Bvh::kLeafSize; }

double halfArea(const Box& box) {
  const Vec3 s = box.size();
  return s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
}

void grow(Box& box, const Box& other) {
  box.lo = box.lo.cwiseMin(other.lo);
  box.hi = box.hi.cwiseMax(other.hi);
}

/// A distance computed to an item may come out smaller than that to its box by rounding: make room for it.
Box padded(const Box& box) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const double pad = 16 * std::numeric_limits<double>::epsilon() * box.diagonal();
  Box out;
  for (int axis = 0; axis < 3; ++axis) {
    out.lo[axis] = std::nextafter(box.lo[axis] - pad, -inf);
    out.hi[axis] = std::nextafter(box.hi[axis] + pad, inf);
  }
  return out;
}

}  // namespace

struct Bvh::BinaryNode {
  FloatBox box;
  Id first = 0;  // leaf: its number; else: left child, the right one follows
  bool isLeaf = false;
};

struct Bvh::Item {
  Box box;
  Id id;
  double key(int axis) const { return 0.5 * box.lo[axis] + 0.5 * box.hi[axis]; }
};

struct Bvh::Builder {
  struct Split {
    int axis = 0;
    Id left = 0;  // items in the left child
  };

  const Bvh& bvh;
  std::vector<Item> items;
  std::vector<BinaryNode> nodes;

  /// Builds node `node` over items [begin, end); its descendants fill nodes [next, next + 2 * leaves - 2).
  void build(Id node, Id begin, Id end, Id next, int depth) {
    Box box, keys;
    for (Id i = begin; i < end; ++i) {
      grow(box, items[i].box);
      keys.add({items[i].key(0), items[i].key(1), items[i].key(2)});
    }
    nodes[node].box = bvh.floatBox(box);
    const Id count = end - begin;
    if (count <= kLeafSize) {
      nodes[node].first = begin / kLeafSize;
      nodes[node].isLeaf = true;
      return;
    }
    const Split split = chooseSplit(keys, begin, end, depth);
    const Id middle = begin + split.left;
    std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                     [axis = split.axis](const Item& a, const Item& b) {
                       const double ka = a.key(axis), kb = b.key(axis);
                       return ka != kb ? ka < kb : a.id < b.id;
                     });
    nodes[node].first = next;
    const Id rightNext = next + 2 * leavesFor(split.left);
    const auto left = [&] { build(next, begin, middle, next + 2, depth + 1); };
    const auto right = [&] { build(next + 1, middle, end, rightNext, depth + 1); };
    if (count > kParallelSize) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

  /// Cheapest of kBins - 1 planes across the longest axis of the keys; halves where weighing cannot help.
  Split chooseSplit(const Box& keys, Id begin, Id end, int depth) const {
    const Id count = end - begin;
    Split split;
    keys.size().maxCoeff(&split.axis);
    split.left = roundToLeaves(count / 2, count);
    const double lo = keys.lo[split.axis], width = keys.size()[split.axis];
    if (count <= kHalvingSize || depth >= kMaxSplitDepth || !(width > 0) || !std::isnormal(kBins / width))
      return split;

    std::array<Box, kBins> boxes;
    std::array<Id, kBins> counts{};
    for (Id i = begin; i < end; ++i) {
      const double place = (items[i].key(split.axis) - lo) * (kBins / width);
      const int bin = std::clamp(static_cast<int>(place), 0, kBins - 1);
      grow(boxes[bin], items[i].box);
      ++counts[bin];
    }
    std::array<double, kBins> rightCost{};
    Box box;
    Id sum = 0;
    for (int bin = kBins - 1; bin > 0; --bin) {
      grow(box, boxes[bin]);
      sum += counts[bin];
      rightCost[bin] = sum > 0 ? sum * halfArea(box) : 0;
    }
    double best = std::numeric_limits<double>::infinity();
    box = Box();
    sum = 0;
    for (int bin = 0; bin + 1 < kBins; ++bin) {
      grow(box, boxes[bin]);
      sum += counts[bin];
      const double cost = (sum > 0 ? sum * halfArea(box) : 0) + rightCost[bin + 1];
      if (sum == 0 || sum == count || !(cost < best)) continue;
      best = cost;
      split.left = roundToLeaves(sum, count);
    }
    return split;
  }

  /// Nearest number of items that fills whole leaves and leaves some for either side.
  static Id roundToLeaves(Id left, Id count) {
    const Id rounded = (left + kLeafSize / 2) / kLeafSize;
    return kLeafSize * std::clamp(rounded, Id(1), leavesFor(count) - 1);
  }
};

Bvh::Bvh(const std::vector<Box>& boxes) {
  if (boxes.empty()) return;
  const Id count = static_cast<Id>(boxes.size());
  Builder builder{*this, std::vector<Item>(boxes.size()),
                  std::vector<BinaryNode>(2 * static_cast<std::size_t>(leavesFor(count)) - 1)};
  tbb::parallel_for(Id(0), count, [&](Id i) { builder.items[i] = {padded(boxes[i]), i}; });
  Box all;
  for (const Item& item : builder.items) grow(all, item.box);
  middle_ = all.centre();
  const double size = all.size().maxCoeff();
  if (std::isnormal(size) && std::isnormal(1 / size)) size_ = size, unit_ = 1 / size;

  builder.build(0, 0, count, 1, 0);
  order_.resize(boxes.size());
  for (Id i = 0; i < count; ++i) order_[i] = builder.items[i].id;
  addNode(builder.nodes, 0);
  nodes_.shrink_to_fit();
}

/// A node of four from nodes of two, and all below it: of the descendants of `top`, the largest gives way to
/// its children until there are four or all are leaves.
Id Bvh::addNode(const std::vector<BinaryNode>& tree, Id top) {
  std::vector<Id> members;
  members.reserve(kWidth);
  members.push_back(top);
  const auto area = [&](Id i) {
    const FloatBox& box = tree[i].box;
    const float x = box.hi[0] - box.lo[0], y = box.hi[1] - box.lo[1], z = box.hi[2] - box.lo[2];
    return tree[i].isLeaf ? -1 : x * y + y * z + z * x;
  };
  while (members.size() < kWidth) {
    const auto widest =
        std::max_element(members.begin(), members.end(), [&](Id i, Id j) { return area(i) < area(j); });
    if (tree[*widest].isLeaf) break;
    const Id first = tree[*widest].first;
    *widest = first;
    members.insert(widest + 1, first + 1);
  }
  Node node;
  node.child.fill(kNoChild);
  for (int lane = 0; lane < kWidth; ++lane) {
    const bool isUsed = lane < static_cast<int>(members.size());
    const FloatBox& box = tree[members[isUsed ? lane : 0]].box;
    for (int a = 0; a < 3; ++a) node.lo[a][lane] = box.lo[a], node.hi[a][lane] = box.hi[a];
  }
  const Id at = static_cast<Id>(nodes_.size());
  nodes_.push_back(node);
  for (std::size_t lane = 0; lane < members.size(); ++lane) {
    const BinaryNode& member = tree[members[lane]];
    const Id child = member.isLeaf ? ~member.first : addNode(tree, members[lane]);
    nodes_[at].child[lane] = child;
  }
  return at;
}

/// Rounded outwards. What is very far away comes nearer, into a cube around all boxes: no distance between
/// grows by that.
Bvh::FloatBox Bvh::floatBox(const Box& box) const {
  constexpr double kFar = 1e6;
  constexpr float kUlp = 1.2e-7f, kLeast = 1e-37f;
  FloatBox out;
  for (int a = 0; a < 3; ++a) {
    const auto relative = [&](double x) {
      return static_cast<float>(std::clamp((x - middle_[a]) * unit_, -kFar, kFar));
    };
    const float lo = relative(box.lo[a]), hi = relative(box.hi[a]);
    out.lo[a] = lo - (kUlp * std::abs(lo) + kLeast);
    out.hi[a] = hi + (kUlp * std::abs(hi) + kLeast);
  }
  return out;
}

Box Bvh::laneBox(const Node& node, int lane) const {
  constexpr double kEps = 4 * std::numeric_limits<double>::epsilon();
  Vec3 lo, hi;
  for (int a = 0; a < 3; ++a) lo[a] = node.lo[a][lane], hi[a] = node.hi[a][lane];
  const Vec3 rounding = kEps * middle_.cwiseAbs();
  return {middle_ - rounding + size_ * lo, middle_ + rounding + size_ * hi};
}

}  // namespace pm
