// SPDX-License-Identifier: BSD-3-Clause
// Feature curves as paths of wall edges: which wall node is to lie where on which curve or corner.
//
// Purpose: a node drawn to the nearest feature (thesis 4.7.2) leaves it to chance whether a mesh *edge* lies
// on the feature. Here each curve between two corners is traced first, as the path of wall edges that runs
// closest to it; its nodes are then spread along the curve, so that every edge between two of them lies on
// it.
//
// Passes: corners closer than half a length scale are one; every corner takes one node, nearest pairs first;
// curves, longest first (in each zone of the mesh they touch), take the cheapest path through nodes nobody
// has taken; nodes of a path are spaced along the arc. Where no path exists (the wall ends, another feature
// is in the way) the curve is bridged by a gap, so that the longest possible pieces are found.
//
// Guarantees: a node has at most one target; paths share no node but corners; a pure function of its
// arguments, the same bits for any number of threads; time O((n + m) log m) for n wall nodes and m pairs of a
// node and a near curve.
#pragma once

#include <functional>

#include "FeatureEdges.h"
#include "WallCuts.h"
#include "WallSurface.h"

namespace pm {

enum class CurveState : std::uint8_t {
  Unreached = 0,  ///< no wall nodes near it
  Short,          ///< shorter than the mesh can show
  Partial,        ///< traced with gaps
  Traced,         ///< one path from end to end
};

/// Where a wall node shall lie; curve is kNone for a node that takes a corner, and the other way round.
struct NodeTarget {
  Id node = kNone;  ///< mesh point
  Id curve = kNone, corner = kNone;
  Vec3 target = Vec3::Zero();
};

struct FeaturePaths {
  std::vector<NodeTarget> targets;  // ascending by node
  std::vector<CurveState> curves;   // #curves
  std::vector<Id> cornerNode;       // #corners mesh point; corners that are one share it
  std::vector<WallCut> cuts;        // faces that paths cross, one cut each; not all paths have them
  Csr<Id> pieces;                   // paths as rows of mesh points
  std::vector<Id> pieceCurve;       // #pieces
};

struct FeaturePathOptions {
  double reach = 1.5;         ///< a path's nodes are at most this many length scales from the curve
  double cornerReach = 1.8;   ///< the same for corners
  double mergeCorners = 0.5;  ///< corners closer than this many length scales are one
  double shortest = 0.5;      ///< open curves below this many length scales are not traced
  double shortestLoop = 2.5;  ///< the same for closed curves
  double spacing = 0.35;      ///< nodes on a curve keep this many length scales, where the curve has room
  std::function<bool(Id node, const Vec3& place)>
      sees;  ///< is the place on the node's side of the geometry? Empty: all are
  std::function<bool(const WallCut&)>
      canCut;  ///< may a path cross this face? Empty: paths keep to wall edges
};

/// What earlier attempts taught, of each wall row; empty: nothing.
struct PathHistory {
  std::vector<float> penalty;     // #W extra cost, in length scales, of nodes that missed their targets
  std::vector<Id> curve, corner;  // #W what the node lies on already, else kNone: no other may take it
};

FeaturePaths traceFeatures(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
                           const FeaturePathOptions& options = {}, const PathHistory& history = {});

/// The curves of a graph by arc length.
class CurveTable {
 public:
  explicit CurveTable(const FeatureGraph& graph);
  double length(Id curve) const { return length_[curve]; }
  Id firstSegment(Id curve) const { return first_[curve]; }
  Id endSegment(Id curve) const { return first_[curve + 1]; }
  /// Arc length at the point of the segment closest to p, and that point.
  double project(const Vec3& p, Id segment, Vec3& on) const;
  /// Point at arc length s, which is wrapped on closed curves and clamped on open ones.
  Vec3 at(Id curve, double s) const;
  /// The curve from one arc length to a larger one.
  std::vector<Vec3> part(Id curve, double from, double to) const;

 private:
  const FeatureGraph& graph_;
  std::vector<Id> first_;       // #curves + 1
  std::vector<double> arc_;     // #segments arc length at its start
  std::vector<double> length_;  // #curves
};

}  // namespace pm
