// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: wall prisms split into boundary layers (thesis 4.8).
#pragma once

#include "MeshQuality.h"

namespace pm {

struct BoundaryRefineOptions {
  int layers = 3;          ///< cells across the layer
  double expansion = 1.2;  ///< height ratio of a layer to the one nearer the wall
  double firstHeight = 0;  ///< height at the wall, user's units; 0 = from layers and expansion
  QualityLimits limits;    ///< minVolume is not applied: layers are thin on purpose
};

struct BoundaryRefineReport {
  Id wallFaces = 0;
  std::vector<Id> facesByLayers;  ///< how many wall faces got 1, 2, .. layers
};

PolyMesh boundaryRefine(const PolyMesh& mesh, const BoundaryRefineOptions& options, Monitor& monitor,
                        BoundaryRefineReport* report = nullptr);

}  // namespace pm
