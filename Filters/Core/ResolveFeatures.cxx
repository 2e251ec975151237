// SPDX-License-Identifier: BSD-3-Clause
#include "ResolveFeatures.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "ChordSplits.h"
#include "FeatureBridges.h"
#include "FeatureCoverage.h"
#include "FeaturePaths.h"
#include "FeatureSnapper.h"
#include "FittingCuts.h"
#include "UnresolvedFeatures.h"
#include "WallFit.h"
#include "WallPatches.h"

namespace pm {
namespace {

// Another round is worth it when no more than this part of the nodes that missed still does; and while they
// are few, of all wall nodes.
constexpr double kWorthARound = 0.85, kFew = 0.002;
constexpr int kBridgeRounds = 3;  // bridges beside each other are built one after the other

/// The stage's state. What knows the wall's faces is brought up to date when faces are cut.
class Resolver {
 public:
  Resolver(PolyMesh& mesh, const DistanceField& field, const FeatureGraph& graph,
           const ResolveFeaturesOptions& options, Monitor& monitor)
      : mesh_(mesh),
        field_(field),
        graph_(graph),
        options_(options),
        monitor_(monitor),
        wall_(wallSurface(mesh)),
        height_(prismHeights(mesh, wall_)) {
    mover_.emplace(mesh_, options_.limits, pointsNearWall(mesh_, 1), &monitor_);
    snapper_.emplace(*mover_, wall_, field_, graph_, height_);
  }

  /// Traces and snaps; nodes that miss make room for others in the next round.
  void snap() {
    PathHistory& history = history_;
    std::size_t missedBefore = std::numeric_limits<std::size_t>::max();
    for (int round = 0; round < options_.rounds; ++round) {
      monitor_.check(0.05 + 0.75 * round / options_.rounds, "feature snapping");
      setTargets(history);
      snapper_->snap(false);
      snapper_->snap(true);
      snapper_->workAround(snapper_->missed());
      snapper_->relax();
      snapper_->force();
      const std::size_t missed = snapper_->missed().size();
      if (missed == 0 || (missed > kFew * wall_.size() && missed > kWorthARound * missedBefore)) break;
      missedBefore = missed;
      snapper_->report(history);
      if (round + 1 < options_.rounds) cut(snapper_->helpfulCuts());
    }
    for (bool corners : {false, true}) snapper_->snap(corners);  // where the last round has made room
    snapper_->workAroundAll();
    missed_ = snapper_->releaseMissed();
    snapper_->relax();
    monitor_.check(0.8, "polishing");
    snapper_->polish();
    snapper_->report(history);
    dropNeedlessCuts();
    bridge(history);
  }

  /// Brings faces nearer to the geometry: by cuts, then by moves of their nodes.
  void fit() {
    monitor_.check(0.85, "fitting faces");
    splitEdges();
    cut(fittingCuts(*mover_, field_));
    fitWall(*mover_, wall_, field_, fitRoles());
    mover_.reset();  // a quarter of the memory, and nothing moves from here on
  }

  const WallSurface& wall() const { return wall_; }
  ResolveFeaturesReport report() const;

 private:
  /// Of the cells behind these faces, wall faces have been cut or merged.
  void renew(const std::vector<Id>& cells) {
    wall_ = {};  // two would be the stage's largest need of memory
    wall_ = wallSurface(mesh_);
    mover_->wallFacesChanged(cells);
  }
  void cut(const std::vector<WallCut>& cuts) {
    if (cuts.empty()) return;
    std::vector<Id> cells;
    for (const WallCut& c : cuts) {
      if (snapper_) snapper_->noteChange(mesh_.faces[c.face]);
      cells.push_back(mesh_.owner[c.face]);
    }
    const std::vector<WallCut> made = cutWallFaces(mesh_, cuts);
    renew(cells);
    for (;;) {
      const std::vector<WallMerge> undo = cutsToUndo(*mover_, made);
      if (undo.empty()) return;
      merge(undo);
    }
  }
  /// Merges cuts that brought nothing.
  void dropNeedlessCuts() {
    const auto isKept = [&](Id a, Id b) { return isOnFeature(a, b); };
    for (;;) {
      const std::vector<WallMerge> merges = needlessCuts(*mover_, field_, isKept);
      if (merges.empty()) return;
      merge(merges);
    }
  }
  /// New nodes where curves found none. The mover gives way meanwhile, and comes back for the new mesh.
  void bridge(PathHistory& held) {
    monitor_.check(0.83, "bridging gaps");
    snapper_.reset();
    mover_.reset();
    const auto inSight = [&](const Vec3& from, const Vec3& to) { return seesFrom(from, to); };
    std::set<GapKey> hopeless;
    for (int round = 0; round < kBridgeRounds; ++round) {
      const BridgesBuilt built =
          bridgeGaps(mesh_, {wall_, field_, graph_, held, options_.limits, inSight}, hopeless);
      if (built.count == 0) break;
      wall_ = wallSurface(mesh_);
      held.curve.insert(held.curve.end(), built.curves.begin(), built.curves.end());
      held.corner.resize(held.curve.size(), kNone);
      if (!built.more) break;
    }
  }
  /// New nodes where edges are chords of the geometry.
  void splitEdges() {
    snapper_.reset();
    mover_.reset();
    const auto inSight = [&](const Vec3& from, const Vec3& to) { return seesFrom(from, to); };
    history_.curve.resize(wall_.size(), kNone);
    history_.corner.resize(wall_.size(), kNone);
    const std::vector<Id> curves =
        splitChords(mesh_, {wall_, field_, graph_, history_, options_.limits, inSight});
    if (!curves.empty()) wall_ = wallSurface(mesh_);
    history_.curve.insert(history_.curve.end(), curves.begin(), curves.end());
    history_.corner.resize(history_.curve.size(), kNone);
    mover_.emplace(mesh_, options_.limits, pointsNearWall(mesh_, 1), &monitor_);
  }
  void merge(const std::vector<WallMerge>& merges) {
    std::vector<Id> cells;
    for (const WallMerge& m : merges) cells.push_back(mesh_.owner[m.first]);
    mergeWallFaces(mesh_, merges);
    renew(cells);
  }
  void setTargets(const PathHistory& history) {
    FeaturePathOptions options;
    options.sees = [&](Id p, const Vec3& place) { return sees(p, place); };
    options.canCut = [&](const WallCut& c) { return mover_->cutHolds(c); };
    const FeaturePaths paths = traceFeatures(mesh_, wall_, graph_, options, history);
    cut(paths.cuts);
    snapper_->setTargets(paths);
  }
  std::vector<FitRole> fitRoles() const;
  bool isOnFeature(Id a, Id b) const;
  bool sees(Id p, const Vec3& place) const {
    return mesh_.base[p] == kNone || seesFrom(mesh_.points[mesh_.base[p]], place);
  }
  bool seesFrom(const Vec3& from, const Vec3& place) const;

  PolyMesh& mesh_;
  const DistanceField& field_;
  const FeatureGraph& graph_;
  const ResolveFeaturesOptions& options_;
  Monitor& monitor_;
  WallSurface wall_;
  const std::vector<double> height_;  // #W prism edges at the start
  std::optional<NodeMover> mover_;
  std::optional<FeatureSnapper> snapper_;
  std::vector<MissedTarget> missed_;
  PathHistory history_;
};

/// Gaps below half a cell are seams of unstitched patches: the octree has sealed them. Wider ones are the
/// user's to name.
FeatureOptions effective(FeatureOptions features, const PolyMesh& mesh) {
  constexpr double kGap = 0.5;
  if (features.gapTolerance <= 0) features.gapTolerance = kGap * mesh.finestSize;
  return features;
}

/// Nodes on features stay; smooth parts of the wall only shift, so that they keep their even mesh.
std::vector<FitRole> Resolver::fitRoles() const {
  constexpr double kOn = 1e-3, kNear = 2.5;  // length scales; the first is what reaches a target
  std::vector<FitRole> roles(wall_.nodes.size(), FitRole::Shift);
  tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
    const double reach = kNear * wall_.scale[row];
    const ClosestOnFeature on = graph_.closest(mesh_.points[wall_.nodes[row]], reach);
    if (on.segment == kNone) return;
    roles[row] = on.distance2 <= std::pow(kOn * wall_.scale[row], 2) ? FitRole::Keep : FitRole::Search;
  });
  return roles;
}

// From the lower end of a prism edge: sheets and walls of parts that touch have features behind them.
bool Resolver::seesFrom(const Vec3& from, const Vec3& place) const {
  constexpr double kThrough = 0.15;  // finest cells that may be left to the place where the geometry is met
  const Vec3 way = place - from;
  const double length = way.norm(), open = length - kThrough * mesh_.finestSize;
  return open <= 0 || !field_.model().crosses(from, from + open / length * way);
}

/// Does the wall edge between two points lie along a feature?
bool Resolver::isOnFeature(Id a, Id b) const {
  constexpr double kOn = 1e-3, kAlong = 0.1;  // of the edge, for its ends and its middle
  const Vec3 &p = mesh_.points[a], &q = mesh_.points[b];
  const double length = (q - p).norm();
  const auto near = [&](const Vec3& at, double part) {
    return graph_.closest(at, part * length).segment != kNone;
  };
  return near(p, kOn) && near(q, kOn) && near(0.5 * (p + q), kAlong);
}

ResolveFeaturesReport Resolver::report() const {
  const CurveTable table(graph_);
  const std::vector<CurveArc> covered = coveredArcs(mesh_, wall_, graph_, table);
  ResolveFeaturesReport report = featureCoverage(mesh_, wall_, graph_, table, covered);
  const WallView view{mesh_, wall_, field_.model(), [&](Id p, const Vec3& at) { return sees(p, at); }};
  report.unresolved = unresolvedFeatures(view, graph_, table, covered, missed_);
  return report;
}

}  // namespace

void resolveFeatures(PolyMesh& mesh, DistanceField& field, const ResolveFeaturesOptions& options,
                     Monitor& monitor, ResolveFeaturesReport* report) {
  if (mesh.stage < Stage::Projected)
    throw InputError("Features can only be resolved on a projected mesh: run Project first.");
  monitor.check(0.0, "feature detection");
  PartMonitor detection(monitor, 0.0, 0.05);
  const FeatureGraph graph = detectFeatures(field.model(), effective(options.features, mesh), &detection);
  Resolver resolver(mesh, field, graph, options, monitor);
  if (resolver.wall().size() > 0) {
    if (!graph.curves().empty()) resolver.snap();
    resolver.fit();
  }
  monitor.check(0.9, "patches");
  assignWallPatches(mesh, field);
  if (report != nullptr) *report = resolver.report();
  canonicalise(mesh);
  mesh.stage = Stage::Resolved;
  monitor.check(1.0, "features done");
}

}  // namespace pm
