// SPDX-License-Identifier: BSD-3-Clause
// Bounding-volume hierarchy over boxes: the one lookup behind triangles, feature segments and open edges.
//
// Built top-down with binned surface-area splits, in parallel, as a tree of two children a node, of which
// every other level then goes: a node holds the boxes of its four children, and a search looks at all four at
// once (Wald, Benthin and Boulos, "Getting rid of packets", 2008). The tree is the same for any number of
// threads. Leaves are runs of kLeafSize slots.
//
// The boxes are kept in single precision, relative to the middle of all and to their size, rounded outwards,
// and so is what a search asks: it may meet a box that it just misses, never the other way round. The answer
// of a nearest query is the minimum over all items of what the caller computes, whatever the order of visits.
#pragma once

#include <array>
#include <vector>

#include "Types.h"

namespace pm {

class Bvh {
 public:
  static constexpr Id kLeafSize = 2, kWidth = 4;

  Bvh() = default;
  explicit Bvh(const std::vector<Box>& boxes);

  /// Item at each slot; leaves are runs of slots, so per-item data copied in this order is read
  /// consecutively.
  const std::vector<Id>& order() const { return order_; }
  std::size_t memoryBytes() const { return nodes_.size() * sizeof(Node) + order_.size() * sizeof(Id); }

  /// Calls visit(slot) for every item whose box is not farther from p than bound2() (a squared length, which
  /// visit may lower as it finds closer items; below zero ends the search), and for some others; nearer
  /// boxes first.
  template <class Visit, class Bound>
  void nearest(const Vec3& p, const Bound& bound2, const Visit& visit) const;

  /// Calls visit(slot) for every item whose box overlaps the box (and for some others near it), until it
  /// returns true; says whether it did.
  template <class Visit>
  bool anyOverlapping(const Box& box, const Visit& visit) const;
  /// The same for all of them.
  template <class Visit>
  void overlapping(const Box& box, const Visit& visit) const {
    anyOverlapping(box, [&](Id slot) {
      visit(slot);
      return false;
    });
  }

  /// Visits the slots of all children that enter(child, box) lets the search into, until visit(slot) returns
  /// true; says whether it did.
  template <class Enter, class Visit>
  bool any(const Enter& enter, const Visit& visit) const;

  /// A value for every child of a node: that of its first slot with those of its other slots merged into it
  /// by merge(value, other).
  template <class Value, class OfSlot, class Merge>
  std::vector<Value> childValues(const OfSlot& ofSlot, const Merge& merge) const;

 private:
  using Floats = float __attribute__((vector_size(16)));
  struct alignas(64) Node {
    Floats lo[3], hi[3];
    std::array<Id, kWidth> child;  // >= 0: node; kNoChild; else of leaf l: ~l
  };
  static constexpr Id kNoChild = std::numeric_limits<Id>::max();
  struct FloatBox {
    float lo[3], hi[3];
  };
  struct BinaryNode;
  struct Item;
  struct Builder;
  struct Pending {
    float distance2;
    Id child;
  };
  // Surface-area splits stop at kMaxSplitDepth; halving from there adds at most 31 levels.
  static constexpr int kMaxSplitDepth = 64;
  static constexpr int kStackSize = (kWidth - 1) * (kMaxSplitDepth + 36);

  Id addNode(const std::vector<BinaryNode>& tree, Id top);
  /// entersOf(node): a function that tells of each of its children whether to enter; visit(slot) ends it.
  template <class Enters, class Visit>
  bool walk(const Enters& entersOf, const Visit& visit) const;
  FloatBox floatBox(const Box& box) const;
  Box laneBox(const Node& node, int lane) const;
  Id firstSlot(Id leaf) const { return kLeafSize * leaf; }
  Id endSlot(Id leaf) const { return std::min(firstSlot(leaf + 1), static_cast<Id>(order_.size())); }
  static Floats distance2(const Node& node, const FloatBox& box);
  /// Of a squared length, with room for rounding of boxes and distances.
  float limit(double bound2) const {
    constexpr double kMost = 1e30;  // above any distance that distance2() can give
    return static_cast<float>(std::min((1 + 4e-6) * bound2 * unit_ * unit_, kMost)) + 1e-37f;
  }

  std::vector<Node> nodes_;
  std::vector<Id> order_;
  Vec3 middle_ = Vec3::Zero();
  double size_ = 1, unit_ = 1;  // unit: 1 / size
};

// Between boxes, along each axis the larger of the two gaps if there is one.
inline Bvh::Floats Bvh::distance2(const Node& node, const FloatBox& box) {
  Floats sum{};
  for (int a = 0; a < 3; ++a) {
    const Floats below = node.lo[a] - box.hi[a], above = box.lo[a] - node.hi[a];
    Floats gap = below > above ? below : above;
    gap = gap > 0 ? gap : Floats{};
    sum += gap * gap;
  }
  return sum;
}

template <class Visit, class Bound>
void Bvh::nearest(const Vec3& p, const Bound& bound2, const Visit& visit) const {
  if (nodes_.empty()) return;
  const FloatBox at = floatBox({p, p});
  std::array<Pending, kStackSize> stack;
  int height = 0;
  float most = limit(bound2());
  for (Pending next{0, 0};;) {
    if (next.child < 0) {
      for (Id slot = firstSlot(~next.child); slot < endSlot(~next.child); ++slot) visit(slot);
      most = limit(bound2());
      next.child = kNoChild;
    } else {
      const Node& node = nodes_[next.child];
      const Floats d2 = distance2(node, at);
      next = {most, kNoChild};
      for (int lane = 0; lane < kWidth; ++lane) {
        Pending child{d2[lane], node.child[lane]};
        if (!(child.distance2 <= most) || child.child == kNoChild) continue;
        if (child.distance2 < next.distance2 || next.child == kNoChild) std::swap(child, next);
        if (child.child != kNoChild) stack[height++] = child;
      }
    }
    while (next.child == kNoChild) {
      if (height == 0) return;
      const Pending last = stack[--height];
      if (last.distance2 <= most) next = last;
    }
  }
}

template <class Enters, class Visit>
bool Bvh::walk(const Enters& entersOf, const Visit& visit) const {
  if (nodes_.empty()) return false;
  std::array<Id, kStackSize> stack;
  int height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Id at = stack[--height];
    const auto enters = entersOf(at);
    for (int lane = 0; lane < kWidth; ++lane) {
      const Id child = nodes_[at].child[lane];
      if (child == kNoChild || !enters(lane)) continue;
      if (child >= 0) {
        stack[height++] = child;
        continue;
      }
      for (Id slot = firstSlot(~child); slot < endSlot(~child); ++slot)
        if (visit(slot)) return true;
    }
  }
  return false;
}

template <class Visit>
bool Bvh::anyOverlapping(const Box& box, const Visit& visit) const {
  const FloatBox of = nodes_.empty() ? FloatBox{} : floatBox(box);
  const auto entersOf = [&](Id at) {
    const Floats d2 = distance2(nodes_[at], of);
    return [d2](int lane) { return d2[lane] <= 0; };
  };
  return walk(entersOf, visit);
}

template <class Enter, class Visit>
bool Bvh::any(const Enter& enter, const Visit& visit) const {
  const auto entersOf = [&](Id at) {
    return [&, at](int lane) { return enter(kWidth * at + lane, laneBox(nodes_[at], lane)); };
  };
  return walk(entersOf, visit);
}

template <class Value, class OfSlot, class Merge>
std::vector<Value> Bvh::childValues(const OfSlot& ofSlot, const Merge& merge) const {
  std::vector<Value> values(kWidth * nodes_.size());
  for (std::size_t i = values.size(); i-- > 0;) {  // children have larger numbers
    const Id child = nodes_[i / kWidth].child[i % kWidth];
    if (child == kNoChild) continue;
    const bool isNode = child >= 0;
    const Id begin = isNode ? kWidth * child : firstSlot(~child),
             end = isNode ? begin + kWidth : endSlot(~child);
    values[i] = isNode ? values[begin] : ofSlot(begin);
    for (Id k = begin + 1; k < end; ++k) {
      if (!isNode)
        merge(values[i], ofSlot(k));
      else if (nodes_[child].child[k - begin] != kNoChild)
        merge(values[i], values[k]);
    }
  }
  return values;
}

}  // namespace pm
