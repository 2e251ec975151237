// SPDX-License-Identifier: BSD-3-Clause
// Looks for a valid shape of layers where the plain one breaks a limit (thesis 4.8: other configurations are
// searched before a split is given up).
//
// For a column with a fault, each of its prism edges may take another course or lean to a side (see
// LayerPoints), and its lower end another place, within the limits of the mesh below. Shapes with layers as
// high as wanted come first. What costs least in the cells around the edge is kept: fewest faults, and these
// nearest to their limits, so that edges which must move one after the other get there (see LayerTrial).
// Wall points do not move. Columns that touch nothing in common are searched in parallel; the result is the
// same for any number of threads.
#pragma once

#include "LayerCheck.h"
#include "LayerPoints.h"
#include "NodeMover.h"

namespace pm {

class LayerSearch {
 public:
  /// mendable: the columns whose edges may move, now or in later calls. All arguments must outlive this.
  LayerSearch(PolyMesh& mesh, LayerColumns& columns, LayerPoints& points, const WallSight& sight,
              LayerCheck& check, const QualityLimits& limits, const std::vector<Id>& mendable,
              const Monitor& monitor);

  /// Whether lower ends of edges may move; they may at first.
  void moveLowerEnds(bool may) { movesEnds_ = may; }
  /// Searches around columns that have faults, each a few times at most: more seldom ends better. Returns
  /// the columns around which something has changed, ascending.
  std::vector<Id> mend(const std::vector<Id>& faulty);

 private:
  static std::vector<Id> lowerEnds(const LayerColumns& columns, const std::vector<Id>& mendable);
  void mendColumn(Id column);
  void mendEdge(Id lower, LayerTrial& trial);
  // Each takes the cost as it is and returns that of the best shape it has found and left behind.
  double tryCourses(Id lower, int first, int last, const std::vector<Id>& around, LayerTrial& trial,
                    double cost);
  double tryLeans(Id lower, LayerTrial& trial, double cost);
  double tryPlaces(Id lower, LayerTrial& trial, double cost);
  bool moveTo(Id lower, const Vec3& to);

  PolyMesh& mesh_;
  LayerColumns& columns_;
  LayerPoints& points_;
  const WallSight& sight_;
  LayerCheck& check_;
  NodeMover mover_;
  bool movesEnds_ = true;
  std::vector<std::uint8_t> searches_;  // #columns
  std::vector<std::uint8_t> changed_;   // #P lower points
};

}  // namespace pm
