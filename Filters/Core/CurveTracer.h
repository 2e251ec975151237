// SPDX-License-Identifier: BSD-3-Clause
// Cheapest path of wall edges along one feature curve, with gaps where there is none (part of FeaturePaths).
#pragma once

#include "FeaturePaths.h"

namespace pm {

/// A wall row near a curve: arc length of its closest point, distance in length scales.
struct NearNode {
  Id row = kNone;
  float distance = 0;
  double arc = 0;
};

/// One node of a traced path.
struct PathNode {
  Id row = kNone;
  double arc = 0;
  bool onCurve = false;  ///< lies on the curve already
  Id cut = kNone;        ///< wall face that the way from the previous node crosses
};

/// May a path cross the face from one of its points to another?
using CanCut = std::function<bool(const WallCut&)>;

/// Dijkstra over the nodes near a curve and, beside them, a chain of the same arc positions: moving along the
/// chain is a gap. A gap costs more than any path within reach, so it is taken only where there is no path.
class CurveTracer {
 public:
  CurveTracer(const PolyMesh& mesh, const WallSurface& wall, const CurveTable& table, const CanCut& canCut)
      : mesh_(mesh), wall_(wall), table_(table), canCut_(canCut), localOf_(wall.nodes.size(), kNone) {}

  struct Task {
    Id curve = kNone;
    double arcShift = 0;                  ///< arc length that counts as the start (closed curves)
    std::vector<NearNode> nodes;          ///< free nodes near the curve, without the ends
    Id startRow = kNone, endRow = kNone;  ///< nodes at the ends, kNone where an end has none; equal on a loop
    double startDistance = 0, endDistance = 0;
    double scale = 1;  ///< typical length scale along the curve
  };
  /// Runs of neighbouring nodes in the order of the curve; arcs are those of the task's nodes.
  std::vector<std::vector<PathNode>> trace(Task& task);

 private:
  struct Vertex {
    double arc, distance, cost;
    Id row, from, cut;
    bool done;
  };
  void build(Task& task);
  void search(const Task& task);
  void relaxNode(const Task& task, Id v);
  void relaxAcross(const Task& task, Id v);
  bool enclosesFace(Id v, Id point) const;
  bool dents(Id face, const Vertex& a, const Vertex& b, const Task& task) const;
  void relaxChain(const Task& task, Id v);
  void relax(Id from, Id to, double cost, Id cut = kNone);
  double edgeCost(const Task& task, const Vertex& a, const Vertex& b) const;
  std::vector<std::vector<PathNode>> unwind(const Task& task) const;

  const PolyMesh& mesh_;
  const WallSurface& wall_;
  const CurveTable& table_;
  const CanCut& canCut_;
  std::vector<Id> localOf_;                   // #W vertex of a row in the running task
  std::vector<Vertex> vertices_;              // nodes, their chain positions, then the two ends of the chain
  std::vector<std::pair<double, Id>> queue_;  // binary heap, smallest first
  Id nodeCount_ = 0, start_ = kNone, end_ = kNone;
};

}  // namespace pm
