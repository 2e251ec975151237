// SPDX-License-Identifier: BSD-3-Clause
// How much of the features mesh edges lie on (part of ResolveFeatures).
#pragma once

#include "FeaturePaths.h"
#include "ResolveFeatures.h"

namespace pm {

/// Fills the report: a part of a curve counts where a wall edge's ends and middle are within 0.1 length
/// scales of it, a corner where a wall node is.
ResolveFeaturesReport featureCoverage(const PolyMesh& mesh, const WallSurface& wall,
                                      const FeatureGraph& graph);

}  // namespace pm
