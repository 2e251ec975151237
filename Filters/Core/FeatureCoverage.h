// SPDX-License-Identifier: BSD-3-Clause
// How much of the features mesh edges lie on (part of ResolveFeatures).
#pragma once

#include "FeaturePaths.h"
#include "ResolveFeatures.h"

namespace pm {

/// Part of a curve between two arc lengths.
struct CurveArc {
  Id curve;
  double from, to;
};

/// The parts of curves where a wall edge's ends and middle are within 0.1 length scales of them; disjoint,
/// ascending by curve and place.
std::vector<CurveArc> coveredArcs(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
                                  const CurveTable& table);

/// Fills the lengths of the report from those parts, and the corners: one counts where a wall node is within
/// 0.1 length scales.
ResolveFeaturesReport featureCoverage(const PolyMesh& mesh, const WallSurface& wall,
                                      const FeatureGraph& graph, const CurveTable& table,
                                      const std::vector<CurveArc>& covered);

}  // namespace pm
