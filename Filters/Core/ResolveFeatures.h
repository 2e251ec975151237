// SPDX-License-Identifier: BSD-3-Clause
// Stage 5: mesh edges onto sharp edges and patch interfaces, nodes onto corners (thesis 4.7).
#pragma once

#include "DistanceField.h"
#include "FeatureEdges.h"
#include "MeshQuality.h"
#include "NodeMover.h"

namespace pm {

struct ResolveFeaturesOptions {
  FeatureOptions features;
  int rounds = 5;  ///< at most: another is done as long as the last was worth it
  QualityLimits limits;
};

/// Why no mesh edges lie on a part of a feature: the first of these that is so.
enum class Unresolved : std::uint8_t {
  NotOnWall,  ///< no wall of the mesh sees it: it lies behind the geometry or where cells close a gap
  Short,      ///< shorter than the mesh's edges can show
  TooClose,   ///< another feature is nearer than 0.7 of the mesh's edges
  Acute,      ///< the surfaces there leave less than 55 degrees to the mesh
  Limit,      ///< a node would break a limit there
  NoPath      ///< the nodes around it are taken by other features
};
/// In words, e.g. "too close to another feature".
const char* describe(Unresolved why);

struct UnresolvedFeature {
  std::vector<Vec3> points;  ///< polyline
  Id curve = kNone;          ///< row of FeatureGraph::curves
  double length = 0;
  Unresolved why = Unresolved::NoPath;
  Refusal limit = Refusal::None;  ///< for Limit; Other: a face would leave the geometry
  double size = 0;  ///< length of mesh edges that would resolve it, an estimate; 0: none is known
};

struct ResolveFeaturesReport {
  double featureLength = 0,
         resolvedLength = 0;  ///< length of all curves; of the parts that mesh edges lie on
  Id corners = 0, resolvedCorners = 0;
  std::vector<UnresolvedFeature> unresolved;  // ascending by curve and place
};

void resolveFeatures(PolyMesh& mesh, DistanceField& field, const ResolveFeaturesOptions& options,
                     Monitor& monitor, ResolveFeaturesReport* report = nullptr);

}  // namespace pm
