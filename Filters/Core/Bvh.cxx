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

  std::vector<Item> items;
  std::vector<Node>& nodes;

  /// Builds node `node` over items [begin, end); its descendants fill nodes [next, next + 2 * leaves - 2).
  void build(Id node, Id begin, Id end, Id next, int depth) {
    Box box, keys;
    for (Id i = begin; i < end; ++i) {
      grow(box, items[i].box);
      keys.add({items[i].key(0), items[i].key(1), items[i].key(2)});
    }
    nodes[node].box = box;
    const Id count = end - begin;
    if (count <= kLeafSize) {
      nodes[node].first = begin;
      nodes[node].count = count;
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
  nodes_.resize(2 * static_cast<std::size_t>(leavesFor(count)) - 1);
  Builder builder{std::vector<Item>(boxes.size()), nodes_};
  tbb::parallel_for(Id(0), count, [&](Id i) { builder.items[i] = {padded(boxes[i]), i}; });
  builder.build(0, 0, count, 1, 0);
  order_.resize(boxes.size());
  for (Id i = 0; i < count; ++i) order_[i] = builder.items[i].id;
}

}  // namespace pm
