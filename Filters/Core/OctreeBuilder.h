// SPDX-License-Identifier: BSD-3-Clause
// The octree while it grows: nodes with children and triangle lists, split in batches.
//
// A tree of nodes makes splitting and neighbour look-up simple while the shape changes; finish() turns its
// leaves into the linear Octree the stages work on. Children of a node are consecutive, so one index a node
// is enough.
#pragma once

#include <vector>

#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

class OctreeBuilder {
 public:
  struct Node {
    Key key = 0;
    Id firstChild = kNone;
    std::uint32_t firstTriangle = 0, triangles = 0;
    std::uint8_t level = 0;
    bool isLeaf() const { return firstChild == kNone; }
    bool isCut() const { return triangles > 0; }
  };

  OctreeBuilder(const Brick& brick, const SurfaceModel& model);

  const Brick& brick() const { return brick_; }
  const Node& node(Id i) const { return nodes_[i]; }
  Id size() const { return static_cast<Id>(nodes_.size()); }
  Id leafCount() const { return static_cast<Id>(leafCount_); }
  Span<Id> triangles(const Node& n) const {
    return {pool_.data() + n.firstTriangle, pool_.data() + n.firstTriangle + n.triangles};
  }
  Box box(const Node& n) const { return brick_.box(n.key, n.level); }
  /// Node at the given level that covers c, or the leaf above it; kNone outside the brick.
  Id find(const Coord& c, int level) const;
  /// Node beside n of n's level (or the coarser leaf there) at a distance of d cells; kNone outside the
  /// brick.
  Id neighbour(const Node& n, const Coord& d) const;

  /// Splits leaves (ascending, unique); children inherit the triangles that touch them. Parallel,
  /// deterministic.
  void split(const std::vector<Id>& leaves);
  /// Grades the tree: within `cells` cells of every split node no leaf is coarser than that node; 1 is the
  /// 2:1 rule over faces, edges and corners.
  void balance(int cells);

  Octree finish() const;

 private:
  /// What the grading asks for: leaves to split, and nodes to look at again because a leaf was more than one
  /// level off.
  struct Grading {
    std::vector<Id> leaves, unsettled;
  };
  Grading tooCoarse(const std::vector<Id>& changed, int cells) const;

  const SurfaceModel& model_;
  Brick brick_;
  std::vector<Node> nodes_;
  std::vector<Id> pool_;  // triangle ids of all nodes
  std::int64_t leafCount_ = 0;
};

}  // namespace pm
