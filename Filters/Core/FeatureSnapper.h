// SPDX-License-Identifier: BSD-3-Clause
// Moves wall nodes onto their feature targets and relaxes the mesh around them (thesis 4.5, 4.7.2; part of
// ResolveFeatures). Every move goes through the NodeMover, so the mesh stays valid.
//
// A node that cannot reach its target alone takes the lower end of its prism edge along. The representative
// points (eq 4-20) that a move takes along may be as far from the geometry as before, or a tenth of the
// length scale; 0.7 of it when the node reaches its feature, since its neighbours follow in the next
// smoothing. A refused move is tried again only after something around it has moved.
#pragma once

#include "DistanceField.h"
#include "FeaturePaths.h"
#include "ForcedMove.h"
#include "NodeMover.h"

namespace pm {

/// A node that could not be put where its curve or corner wants it.
struct MissedTarget {
  Id row, curve, corner;  ///< wall row; curve or corner is kNone
  Refusal limit;          ///< Other: a face would leave the geometry
};

/// Lengths of the prism edges below the wall's nodes, 0 where there is none. #W
std::vector<double> prismHeights(const PolyMesh& mesh, const WallSurface& wall);

class FeatureSnapper {
 public:
  FeatureSnapper(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
                 const FeatureGraph& graph, const std::vector<double>& height);

  /// Takes over targets.
  void setTargets(const FeaturePaths& paths);
  /// Something about these points has changed other than by the snapper's own moves.
  void noteChange(Span<Id> points);
  /// relax() and polish() keep to two rings of wall nodes around these rows; around all targets.
  void workAround(std::vector<Id> rows);
  void workAroundAll();
  /// Moves the nodes of curves, or those of corners, towards their targets, nearest first (eq 4-31).
  void snap(bool corners);
  /// Smooths free wall nodes along the geometry together with the lower ends of prism edges, then the points
  /// below.
  void relax();
  /// As relax, but only points with a measure close to its limit move, and a move must also improve the worst
  /// one; nodes on curves slide along them.
  void polish();
  /// Wall rows whose targets are not reached.
  std::vector<Id> missed() const;
  /// Notes who lies on what, and who missed.
  void report(PathHistory& history) const;
  /// Cuts of wall faces that stand in the way of nodes that missed (thesis 4.7.3).
  std::vector<WallCut> helpfulCuts() const;
  /// Forces nodes that missed to their targets and lets the points around them give way; puts back what does
  /// not end valid (thesis 4.4.1).
  void force();
  /// Gives up the targets that were not reached: their nodes are smoothed along the geometry like any other.
  /// Returns them with what refused the last attempt.
  std::vector<MissedTarget> releaseMissed();

 private:
  enum class Role : std::uint8_t { Outside, Free, Curve, Corner };
  // In length scales: how far a face may leave the geometry when a node reaches a feature (its neighbours
  // follow: a tight limit here leaves them all behind), goes part of the way, is smoothed.
  static constexpr double kSnapTolerance = 0.7, kDriftTolerance = 0.1, kSmoothTolerance = 0.02;

  bool reached(Id row) const;
  double distance(Id row) const;
  void snapNode(Id row);
  bool crowdsPath(Id row, const Vec3& at) const;
  bool tryMove(Id row, const Vec3& to, double tolerance);
  bool staysNear(Id row, const Vec3& from, const Vec3& to, double limit) const;
  bool canReach(Id row) const;
  bool improveNear(Id row, const Vec3& to, double badness);
  double deviation(Id row, const Vec3& at, double enough) const;
  Vec3 smoothedNode(Id row) const;
  Vec3 settledBase(Id row, const Vec3& top) const;
  void relaxAll(const std::vector<Id>& rows);
  void slideOnCurve(Id row);
  std::vector<std::vector<Id>> columnGroups(const std::vector<Id>& rows) const;
  bool stirred(Id row, std::vector<Id>& tried);
  bool stirredBelow(Id point);
  void smoothInner();
  void forceNode(Id row, Span<Id> points);
  void mendWallNode(Id row);
  double qualityAt(const std::vector<Vec3>& at, const std::vector<Id>& ids) const;
  WallCut cutFor(Id row) const;
  template <class Body>
  void forEachRow(const std::vector<std::vector<Id>>& groups, const Body& body);

  NodeMover& mover_;
  const PolyMesh& mesh_;
  const WallSurface& wall_;
  const DistanceField& field_;
  const FeatureGraph& graph_;
  const std::vector<double>& height_;  // #W length that prism edges are drawn to
  ForcedMove forced_;
  std::vector<char> isBase_;        // #P lower end of a prism edge
  std::vector<Role> role_;          // #W
  std::vector<Vec3> target_;        // #W
  std::vector<Id> curve_, corner_;  // #W
  std::vector<Id> before_, after_;  // #W neighbours on the path, kNone at its ends
  Id pass_ = 1;                     // counts sweeps over rows or points
  std::vector<Id> changed_;         // #P pass in which the point moved last
  std::vector<Id> snapTried_, forceTried_, relaxTried_,
      innerTried_;              // #W, and #P the last: pass of the last attempt
  std::vector<char> wentBack_;  // #P in the last relaxAll()
  std::vector<Id> active_;      // rows around targets
  std::vector<Id> inner_;       // points below them
};

}  // namespace pm
