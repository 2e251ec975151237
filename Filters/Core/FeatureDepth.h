// SPDX-License-Identifier: BSD-3-Clause
// Criteria 5 and 7: cells on and near critical edges and points, and how deep they are split.
//
// Full depth splits every such cell to the finest level, as the thesis does. As needed, a cell is split only
// while it and its neighbours hold features that one cell cannot tell apart: two corners, two curves that do
// not meet in a corner there, a curve that turns by more than kMostTurn, or one that leaves its chord over
// the cell by more than kMostSag of the finest cell, or one beside which the surfaces bend so much that the
// sharp edge is none any more at the size of the cell, or one whose sides face each other by closeAngle. What
// is left are cells with one straight piece of a curve, or one corner and the curves from it. Cells within
// featureBuffer finest cells of a feature that asks follow it, as at full depth; and so do the other cells
// along the same curve, if it is not long (RefinementCriteria::evenCurves).
#pragma once

#include <vector>

#include "FeatureEdges.h"
#include "OctreeDecompose.h"

namespace pm {

class FeatureDemand {
 public:
  static constexpr double kMostTurn = 30;        ///< degrees, over a cell and its neighbours
  static constexpr double kMostSag = 1. / 20;    ///< of the finest cell's edge
  static constexpr double kLeastShare = 2. / 3;  ///< of the sharp angle, over a cell to either side

  /// Finds the model's critical edges; keeps references to the model and the options.
  FeatureDemand(const SurfaceModel& model, const OctreeDecomposeOptions& options, double finest,
                Monitor& monitor);

  enum class Answer {
    None,   ///< no feature near
    Split,  ///< a feature in the cell asks
    Near,   ///< a feature close to the cell asks
    Keep    ///< a feature that the cell resolves as it is
  };
  struct Demand {
    Answer answer = Answer::None;
    int sides = 1;  ///< Keep: smooth pieces of surface that meet at the feature
  };
  /// Thread-safe.
  Demand at(const Box& cell) const;
  /// Curves of critical edges, up to a length, that run through a cell or a cell beside it, ascending.
  /// Thread-safe.
  std::vector<Id> curvesNear(const Box& cell, double longest) const;

  const FeatureGraph& graph() const { return graph_; }

 private:
  bool counts(const FeatureSegment& segment) const { return (segment.kind & kinds_) != 0; }
  Answer fullDepth(const Box& cell) const;
  Demand asNeeded(const Box& leaf) const;
  struct Run;
  std::vector<Run> runsNear(const Box& around, const Box& cell) const;
  bool isNear(const Box& cell, const std::vector<Run>& runs) const;
  bool turns(const Run& run) const;
  bool sags(const Box& cell, const Run& run) const;
  bool looksBluntOrAcute(const Box& part, const Run& run, double radius) const;

  const SurfaceModel& model_;
  const OctreeDecomposeOptions& options_;
  const double finest_;
  FeatureGraph graph_;
  std::uint8_t kinds_ = 0;       // FeatureKind bits that count
  std::vector<double> length_;   // #curves
  std::vector<Id> loneCorners_;  // corners at which no counted curve ends
};

}  // namespace pm
