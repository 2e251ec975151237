// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: one prismatic cell on each front face (thesis 4.2.3, eqs 4-1, 4-2), valid.
#pragma once

#include "MeshQuality.h"

namespace pm {

struct DummyLayerOptions {
  double thickness = 1.0 / 3.0;  ///< prism height over the node's length scale (4-2)
  QualityLimits limits;
};

PolyMesh dummyLayer(const PolyMesh& front, const DummyLayerOptions& options, Monitor& monitor);
/// The same; frees the front as soon as the layer stands on it.
PolyMesh dummyLayer(PolyMesh&& front, const DummyLayerOptions& options, Monitor& monitor);

}  // namespace pm
