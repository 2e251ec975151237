// SPDX-License-Identifier: BSD-3-Clause
// Bounding-volume hierarchy over boxes: the one lookup behind triangles, feature segments and open edges.
//
// Built top-down with binned surface-area splits, in parallel; the tree is the same for any number of
// threads. Leaves hold kLeafSize items but for the last one of each odd remainder, so the number of nodes of
// every subtree is known before it is built and the nodes lie in one flat array, both children of a node side
// by side.
//
// Nearest queries prune with a slack that covers rounding of the caller's distances (a few eps of the item's
// size and of the distance): the answer is the minimum over all items of what the caller computes, whatever
// the order of visits.
#pragma once

#include <array>
#include <vector>

#include "Types.h"

namespace pm {

class Bvh {
 public:
  static constexpr Id kLeafSize = 4;

  Bvh() = default;
  explicit Bvh(const std::vector<Box>& boxes);

  /// Item at each slot; leaves are runs of slots, so per-item data copied in this order is read
  /// consecutively.
  const std::vector<Id>& order() const { return order_; }
  std::size_t memoryBytes() const { return nodes_.size() * sizeof(Node) + order_.size() * sizeof(Id); }

  /// Calls visit(slot) for every item whose box is not farther from p than bound2() (a squared length, which
  /// visit may lower as it finds closer items); nearer boxes first.
  template <class Visit, class Bound>
  void nearest(const Vec3& p, const Bound& bound2, const Visit& visit) const;

  /// Calls visit(slot) for every item whose box overlaps the box (and perhaps a few others that nearly do).
  template <class Visit>
  void overlapping(const Box& box, const Visit& visit) const;

  /// Visits the slots of all nodes that enter(node, box) lets the search into, until visit(slot) returns
  /// true; says whether it did.
  template <class Enter, class Visit>
  bool any(const Enter& enter, const Visit& visit) const;

  /// A value for every node: that of its first slot with those of its other slots merged into it by
  /// merge(value, other).
  template <class Value, class OfSlot, class Merge>
  std::vector<Value> nodeValues(const OfSlot& ofSlot, const Merge& merge) const;

 private:
  struct alignas(64) Node {
    Box box;
    Id first = 0;  // leaf: first slot; else: left child, the right one follows
    Id count = 0;  // leaf: number of slots; else 0
  };
  struct Item;
  struct Builder;
  struct Pending {
    double distance2;
    Id node;
  };
  // Surface-area splits stop at kMaxSplitDepth; halving from there adds at most 31 levels.
  static constexpr int kMaxSplitDepth = 64;
  static constexpr int kStackSize = kMaxSplitDepth + 36;
  static constexpr double kSlack = 1 - 1e-14;

  static double bound(const Node& node, const Vec3& p) { return kSlack * node.box.distance2(p); }

  std::vector<Node> nodes_;
  std::vector<Id> order_;
};

template <class Visit, class Bound>
void Bvh::nearest(const Vec3& p, const Bound& bound2, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<Pending, kStackSize> stack;
  int height = 0;
  Pending next{bound(nodes_[0], p), 0};
  for (;;) {
    if (next.distance2 <= bound2()) {
      const Node& node = nodes_[next.node];
      if (node.count == 0) {
        Pending near{bound(nodes_[node.first], p), node.first};
        Pending far{bound(nodes_[node.first + 1], p), node.first + 1};
        if (far.distance2 < near.distance2) std::swap(near, far);
        if (far.distance2 <= bound2()) stack[height++] = far;
        next = near;
        continue;
      }
      for (Id slot = node.first; slot < node.first + node.count; ++slot) visit(slot);
    }
    if (height == 0) return;
    next = stack[--height];
  }
}

template <class Visit>
void Bvh::overlapping(const Box& box, const Visit& visit) const {
  if (nodes_.empty() || !nodes_[0].box.overlaps(box)) return;
  std::array<Id, kStackSize> stack;
  int height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Node& node = nodes_[stack[--height]];
    for (Id slot = node.first; slot < node.first + node.count; ++slot) visit(slot);
    if (node.count > 0) continue;
    for (Id child = node.first + 1; child >= node.first; --child)
      if (nodes_[child].box.overlaps(box)) stack[height++] = child;
  }
}

template <class Enter, class Visit>
bool Bvh::any(const Enter& enter, const Visit& visit) const {
  if (nodes_.empty() || !enter(Id(0), nodes_[0].box)) return false;
  std::array<Id, kStackSize> stack;
  int height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Node& node = nodes_[stack[--height]];
    for (Id slot = node.first; slot < node.first + node.count; ++slot)
      if (visit(slot)) return true;
    if (node.count > 0) continue;
    for (Id child = node.first + 1; child >= node.first; --child)
      if (enter(child, nodes_[child].box)) stack[height++] = child;
  }
  return false;
}

template <class Value, class OfSlot, class Merge>
std::vector<Value> Bvh::nodeValues(const OfSlot& ofSlot, const Merge& merge) const {
  std::vector<Value> values(nodes_.size());
  for (Id i = static_cast<Id>(nodes_.size()) - 1; i >= 0; --i) {  // children have larger numbers
    const Node& node = nodes_[i];
    values[i] = node.count > 0 ? ofSlot(node.first) : values[node.first];
    if (node.count == 0) merge(values[i], values[node.first + 1]);
    for (Id k = 1; k < node.count; ++k) merge(values[i], ofSlot(node.first + k));
  }
  return values;
}

}  // namespace pm
