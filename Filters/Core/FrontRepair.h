// SPDX-License-Identifier: BSD-3-Clause
// Makes the front fit for a prism layer: filling, growing and disconnection (thesis 3.5.1, Figs 3-28..3-33).
#pragma once

#include <array>
#include <vector>

#include "Monitor.h"
#include "Octree.h"
#include "PaintFront.h"
#include "SurfaceModel.h"

namespace pm {

class FrontRepair {
 public:
  /// regionOf: #L region of each painted leaf; an added leaf gets that of its painted neighbours, and a leaf
  /// between two regions is never added.
  FrontRepair(const Octree& tree, const SurfaceModel& model, std::vector<std::uint8_t>& painted,
              std::vector<Id>& regionOf);

  /// Paints cells with painted neighbours on opposite sides that both see the cell's centre; returns how
  /// many.
  Id fill();
  /// Adds and removes single cells until every front node is in a permitted pattern. Ends always: a cell is
  /// added at most once, and a removed one never comes back.
  void clean(Monitor& monitor, PaintFrontReport& report);

 private:
  /// A leaf and the leaves that touch it, as a lattice of 4 (3 for a finest leaf) places along each axis with
  /// the leaf itself in the middle; leaves are at x + 4 y + 16 z.
  struct Surroundings {
    Coord corner;
    std::int32_t step;
    int steps;  // between the leaf's nodes along each axis
    std::array<Id, 64> leaves;
  };
  Key axisKey(std::int32_t x, int axis) const;
  std::array<Id, 8> leavesAround(const Coord& node) const;
  Surroundings surroundings(Id leaf) const;
  template <class Body>
  void forSurroundings(Id leaf, const Body& body) const;

  /// The paint of `flipped` (or kNone) counts as if it were the other one.
  bool forbidden(const Coord& node, const std::array<Id, 8>& leaves, Id flipped) const;
  bool isFront(Id leaf) const;
  std::vector<Key> cornersOfFront(const std::vector<Id>& leaves) const;
  /// Forbidden nodes at corners of those of the leaves that are painted and at the front, ascending by key.
  std::vector<Coord> forbiddenNodes(const std::vector<Id>& leaves) const;
  /// Forbidden nodes on the surface of a leaf.
  int forbiddenOn(const Surroundings& s, Id flipped) const;
  /// By how much the number of forbidden nodes would fall if the leaf's paint were flipped.
  int gain(Id leaf) const;
  bool isBetweenPainted(Id leaf) const;
  bool seesPaintedNeighbours(Id leaf) const;
  bool inSight(Id from, Id to) const;
  /// The one region of the painted face neighbours, kNone when there are none or several.
  Id regionBeside(Id leaf) const;
  void add(Id leaf, Id region);
  double roominess(Id leaf) const;
  bool growAt(const Coord& node);
  bool removeAt(const Coord& node);
  void markChanged(Id leaf);
  std::vector<Id> aroundChanged() const;

  const Octree& tree_;
  const SurfaceModel& model_;
  std::vector<std::uint8_t>& painted_;
  std::vector<Id>& regionOf_;
  std::vector<std::uint8_t> touched_;      // leaf was added or removed before
  std::vector<std::uint8_t> gainChanged_;  // a leaf beside it was painted in this round of filling
  std::vector<Id> changed_;                // leaves added or removed in this round of cleaning
};

template <class Body>
void FrontRepair::forSurroundings(Id leaf, const Body& body) const {
  const Surroundings s = surroundings(leaf);
  for (int z = 0; z <= s.steps + 1; ++z)
    for (int y = 0; y <= s.steps + 1; ++y)
      for (int x = 0; x <= s.steps + 1; ++x) body(s.leaves[x + 4 * y + 16 * z]);
}

}  // namespace pm
