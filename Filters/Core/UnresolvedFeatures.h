// SPDX-License-Identifier: BSD-3-Clause
// Which parts of features no mesh edges lie on, why, and the edge length that would resolve them (part of
// ResolveFeatures).
//
// What the covered arcs leave of the curves is walked in steps of half a finest cell. Each step asks the
// wall nodes around it, in the order of Unresolved; steps with one answer are one part. The wedge that the
// mesh fills is measured by the geometry itself, going round the curve from the mesh's side until a triangle
// is in the way, so it needs no orientation and no clean topology.
//
// A pure function of its arguments, the same bits for any number of threads; time O((n + s) log n) for n wall
// nodes and s steps.
#pragma once

#include <functional>

#include "FeatureCoverage.h"
#include "FeatureSnapper.h"

namespace pm {

/// The wall and what can be seen from it.
struct WallView {
  const PolyMesh& mesh;
  const WallSurface& wall;
  const SurfaceModel& model;
  std::function<bool(Id node, const Vec3& place)> sees;
};

std::vector<UnresolvedFeature> unresolvedFeatures(const WallView& view, const FeatureGraph& graph,
                                                  const CurveTable& table,
                                                  const std::vector<CurveArc>& covered,
                                                  const std::vector<MissedTarget>& missed);

}  // namespace pm
