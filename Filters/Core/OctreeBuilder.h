// SPDX-License-Identifier: BSD-3-Clause
// The octree while it grows: nodes with children and triangle lists, split in batches.
//
// A tree of nodes makes splitting and neighbour look-up simple while the shape changes; finish() turns its
// leaves into the linear Octree the stages work on. Children of a node are consecutive, so one index a node
// is enough.
//
// Localisation (thesis 3.3.2): the root cells are a uniform grid that triangles are put into directly; below,
// children test the triangles of their parent, whose list is then dropped. Lists come from count, prefix sum
// and fill over runs of triangles, so that a single cell with all triangles keeps every thread busy. A
// triangle that misses a cell by no more than touchSlack() still counts as touching it, so that rounding
// never opens a hole in a surface that lies on cell faces.
//
// Memory: 27 bytes a leaf while growing and at most 42 in finish(), beside the lists, which take at most
// thrice their final size.
#pragma once

#include <array>
#include <vector>

#include "ChunkedArray.h"
#include "Octree.h"
#include "RefineReason.h"
#include "SurfaceModel.h"

namespace pm {

class OctreeBuilder {
 public:
  struct Node {
    Key key = 0;
    Id firstChild = kNone;
    std::uint32_t firstTriangle = 0, triangles = 0;
    std::uint8_t level = 0;
    RefineReason reason = RefineReason::Root;  ///< what split the parent, and for which patch
    std::int16_t patch = -1;
    bool isLeaf() const { return firstChild == kNone; }
    bool isCut() const { return triangles > 0; }
  };

  OctreeBuilder(const Brick& brick, const SurfaceModel& model);

  const Brick& brick() const { return brick_; }
  const Node& node(Id i) const { return nodes_[i]; }
  Id size() const { return static_cast<Id>(nodes_.size()); }
  Id leafCount() const { return static_cast<Id>(leafCount_); }
  /// Triangles that touch a leaf, ascending; empty for a split node, whose list is gone.
  Span<Id> triangles(const Node& n) const {
    if (!n.isLeaf()) return {};
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
  /// Notes on a split node's children what split it; until then they count as made by balancing. The leaves
  /// show it to the user.
  void explain(Id parent, const RefineCause& cause);
  /// Grades the tree: within `cells` cells of every split node no leaf is coarser than that node; 1 is the
  /// 2:1 rule over faces, edges and corners.
  void balance(int cells);

  Octree finish() const&;
  /// Leaves the builder empty, so that nodes and leaves are in memory together only while one becomes the
  /// other.
  Octree finish() &&;

 private:
  /// What the grading asks for: leaves to split, and nodes to look at again because a leaf was more than one
  /// level off.
  struct Grading {
    std::vector<Id> leaves, unsettled;
  };
  /// Members of the eight children that start at `first`.
  struct Family {
    Id first;
    std::uint8_t members;
  };
  std::vector<Family> familiesOf(const std::vector<Id>& ascending) const;
  void lookAround(const Family& family, int cells, Grading& found) const;
  Grading tooCoarse(const std::vector<Id>& changed, int cells) const;

  /// Consecutive triangles of a leaf's list, and how many of them touch each child.
  struct Run {
    Id leaf;
    std::uint32_t first, count;  // in pool_
    std::size_t firstByte;       // in the array of bytes that tell the touched children
    std::array<std::uint32_t, 8> inChild;
  };
  void makeRoots();
  void listRoots();
  std::vector<Run> runsOf(const std::vector<Id>& leaves) const;
  void testChildren(Run& run, std::uint8_t* touched) const;
  void fillChildren(const Run& run, const std::uint8_t* touched);
  void makeRoom(std::vector<Run>& runs, Id firstNew);
  void dropOldLists();

  /// A subtree whose leaves fill consecutive places of the linear octree.
  struct Part {
    Id node;
    Id firstLeaf = 0, leaves = 0;
    std::int64_t firstTriangle = 0, triangles = 0;
  };
  std::vector<Part> partsInOrder() const;
  template <class Body>
  void forLeavesBelow(Id i, const Body& body) const;
  Octree collect() const;

  const SurfaceModel& model_;
  Brick brick_;
  std::vector<double> slack_;  // touchSlack() of each level
  ChunkedArray<Node> nodes_;
  std::vector<Id> pool_;         // triangle lists of the leaves, and of split nodes until dropOldLists()
  std::size_t poolGarbage_ = 0;  // entries of split nodes
  std::int64_t leafCount_ = 0;
};

}  // namespace pm
