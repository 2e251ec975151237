// SPDX-License-Identifier: BSD-3-Clause
#include "ResolveFeatures.h"

#include <fmt/core.h>

#include "FeatureCoverage.h"
#include "FeaturePaths.h"
#include "FeatureSnapper.h"
#include "NodeMover.h"
#include "WallPatches.h"

namespace pm {
namespace {

constexpr int kSteps = 4;  // snapping and relaxing after each tracing
constexpr int kPolishSweeps = 2;
constexpr float kMissPenalty =
    0.3f;  // length scales a node counts as farther for each round it missed its target

/// Traces and snaps; nodes that miss make room for others in the next round.
void snapRounds(PolyMesh& mesh, const WallSurface& wall, const DistanceField& field,
                const FeatureGraph& graph, const ResolveFeaturesOptions& options, Monitor& monitor) {
  NodeMover mover(mesh, options.limits);
  FeatureSnapper snapper(mover, wall, field, graph);
  std::vector<float> penalty(wall.nodes.size(), 0.0f);
  const double steps = options.rounds * kSteps;
  for (int round = 0; round < options.rounds; ++round) {
    snapper.setTargets(traceFeatures(mesh, wall, graph, {}, penalty));
    for (int step = 0; step < kSteps; ++step) {
      monitor.check(0.05 + 0.75 * (round * kSteps + step) / steps, "feature snapping");
      snapper.snap(false);
      snapper.snap(true);
      snapper.relax();
    }
    const std::vector<Id> missed = snapper.missed();
    if (missed.empty()) break;
    for (Id row : missed) penalty[row] += kMissPenalty;
  }
  for (int sweep = 0; sweep < kPolishSweeps; ++sweep) {
    monitor.check(0.8 + 0.1 * sweep / kPolishSweeps, "polishing");
    snapper.polish();
  }
}

}  // namespace

void resolveFeatures(PolyMesh& mesh, DistanceField& field, const ResolveFeaturesOptions& options,
                     Monitor& monitor, ResolveFeaturesReport* report) {
  if (mesh.stage < Stage::Projected)
    throw InputError("Features can only be resolved on a projected mesh: run Project first.");
  monitor.check(0.0, "feature detection");
  const FeatureGraph graph = detectFeatures(field.model(), options.features);
  const WallSurface wall = wallSurface(mesh);
  if (!graph.curves().empty() && wall.size() > 0) snapRounds(mesh, wall, field, graph, options, monitor);
  monitor.check(0.9, "patches");
  assignWallPatches(mesh, field);
  if (report != nullptr) *report = featureCoverage(mesh, wall, graph);
  canonicalise(mesh);
  mesh.stage = Stage::Resolved;
  monitor.check(1.0, "features done");
}

}  // namespace pm
