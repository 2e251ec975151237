// SPDX-License-Identifier: BSD-3-Clause
// Stage 5: mesh edges onto sharp edges and patch interfaces, nodes onto corners (thesis 4.7).
#pragma once

#include "DistanceField.h"
#include "FeatureEdges.h"
#include "MeshQuality.h"

namespace pm {

struct ResolveFeaturesOptions {
  FeatureOptions features;
  int rounds = 4;
  QualityLimits limits;
};

struct ResolveFeaturesReport {
  double featureLength = 0,
         resolvedLength = 0;  ///< length of all curves; of the parts that mesh edges lie on
  Id corners = 0, resolvedCorners = 0;
};

void resolveFeatures(PolyMesh& mesh, DistanceField& field, const ResolveFeaturesOptions& options,
                     Monitor& monitor, ResolveFeaturesReport* report = nullptr);

}  // namespace pm
