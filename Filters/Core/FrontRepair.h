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
  FrontRepair(const Octree& tree, const SurfaceModel& model, std::vector<std::uint8_t>& painted);

  /// Paints cells with painted neighbours on opposite sides that both see the cell's centre; returns how
  /// many.
  Id fill();
  /// Adds and removes single cells until every front node is in a permitted pattern. Ends always: a cell is
  /// added at most once, and a removed one never comes back.
  void clean(Monitor& monitor, PaintFrontReport& report);

 private:
  std::array<Id, 8> leavesAround(const Coord& node) const;
  bool forbidden(const Coord& node) const;
  std::vector<Coord> forbiddenNodes() const;
  /// Forbidden nodes on the surface of a leaf.
  int forbiddenOn(Id leaf) const;
  /// Change in the number of forbidden nodes if the leaf's paint were flipped.
  int gain(Id leaf);
  bool hasPaintedNeighbourInSight(Id leaf) const;
  bool inSight(Id from, Id to) const;
  bool growAt(const Coord& node);
  bool removeAt(const Coord& node);

  const Octree& tree_;
  const SurfaceModel& model_;
  std::vector<std::uint8_t>& painted_;
  std::vector<std::uint8_t> touched_;  // leaf was added or removed before
};

}  // namespace pm
