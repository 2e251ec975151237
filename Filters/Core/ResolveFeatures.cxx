// SPDX-License-Identifier: BSD-3-Clause
#include "ResolveFeatures.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "FeatureCoverage.h"
#include "FeaturePaths.h"
#include "FeatureSnapper.h"
#include "NodeMover.h"
#include "WallFit.h"
#include "WallPatches.h"

namespace pm {
namespace {

constexpr int kSteps = 4;  // snapping and relaxing after each tracing
constexpr int kPolishSweeps = 2;
// Length scales a node counts as farther for each round it missed its target.
constexpr float kMissPenalty = 0.3f;

/// Traces and snaps; nodes that miss make room for others in the next round.
void snapRounds(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
                const FeatureGraph& graph, const ResolveFeaturesOptions& options, Monitor& monitor) {
  const PolyMesh& mesh = mover.mesh();
  FeatureSnapper snapper(mover, wall, field, graph);
  std::vector<float> penalty(wall.nodes.size(), 0.0f);
  std::size_t fewest = wall.nodes.size() + 1;
  const double steps = options.rounds * kSteps;
  for (int round = 0; round < options.rounds; ++round) {
    snapper.setTargets(traceFeatures(mesh, wall, graph, {}, penalty));
    std::size_t before = wall.nodes.size();
    for (int step = 0; step < kSteps; ++step) {
      monitor.check(0.05 + 0.75 * (round * kSteps + step) / steps, "feature snapping");
      snapper.snap(false);
      snapper.snap(true);
      snapper.relax();
      const std::size_t open = snapper.missed().size();
      if (open >= before) break;
      before = open;
    }
    const std::vector<Id> missed = snapper.missed();
    if (missed.empty() || missed.size() >= fewest) break;
    fewest = missed.size();
    for (Id row : missed) penalty[row] += kMissPenalty;
  }
  snapper.releaseMissed();
  snapper.relax();
  for (int sweep = 0; sweep < kPolishSweeps; ++sweep) {
    monitor.check(0.8 + 0.1 * sweep / kPolishSweeps, "polishing");
    snapper.polish();
  }
}

/// Gaps below half a cell are seams of unstitched patches: the octree has sealed them. Wider ones are the
/// user's to name.
FeatureOptions effective(FeatureOptions features, const PolyMesh& mesh) {
  constexpr double kGap = 0.5;
  if (features.gapTolerance <= 0) features.gapTolerance = kGap * mesh.finestSize;
  return features;
}

/// Nodes on features stay; smooth parts of the wall only shift, so that they keep their even mesh.
std::vector<FitRole> fitRoles(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph) {
  constexpr double kOn = 1e-3, kNear = 2.5;  // length scales; the first is what reaches a target
  std::vector<FitRole> roles(wall.nodes.size(), FitRole::Shift);
  tbb::parallel_for(Id(0), wall.size(), [&](Id row) {
    const double reach = kNear * wall.scale[row];
    const ClosestOnFeature on = graph.closest(mesh.points[wall.nodes[row]], reach);
    if (on.segment == kNone) return;
    roles[row] = on.distance2 <= std::pow(kOn * wall.scale[row], 2) ? FitRole::Keep : FitRole::Search;
  });
  return roles;
}

}  // namespace

void resolveFeatures(PolyMesh& mesh, DistanceField& field, const ResolveFeaturesOptions& options,
                     Monitor& monitor, ResolveFeaturesReport* report) {
  if (mesh.stage < Stage::Projected)
    throw InputError("Features can only be resolved on a projected mesh: run Project first.");
  monitor.check(0.0, "feature detection");
  PartMonitor detection(monitor, 0.0, 0.05);
  const FeatureGraph graph = detectFeatures(field.model(), effective(options.features, mesh), &detection);
  const WallSurface wall = wallSurface(mesh);
  if (wall.size() > 0) {
    NodeMover mover(mesh, options.limits, &monitor);
    if (!graph.curves().empty()) snapRounds(mover, wall, field, graph, options, monitor);
    monitor.check(0.85, "fitting faces");
    fitWall(mover, wall, field, fitRoles(mesh, wall, graph));
  }
  monitor.check(0.9, "patches");
  assignWallPatches(mesh, field);
  if (report != nullptr) *report = featureCoverage(mesh, wall, graph);
  canonicalise(mesh);
  mesh.stage = Stage::Resolved;
  monitor.check(1.0, "features done");
}

}  // namespace pm
