// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: wall nodes drift onto the geometry, valid at every move (thesis 4.4.1, 4.5, 4.6.2).
#pragma once

#include <vector>

#include "DistanceField.h"
#include "MeshQuality.h"

namespace pm {

struct ProjectOptions {
  int rounds = 6;  ///< the last four smooth the front along the geometry, those before lead it there
  QualityLimits limits;
};

/// A wall node that stayed more than 0.02 of its length scale short of the geometry.
struct StuckNode {
  Vec3 position = Vec3::Zero();
  double distance = 0;      ///< to the geometry, its units
  const char* heldBy = "";  ///< the limit that its last way would have broken
};

/// stuck: null, or receives the nodes that could not reach the geometry.
void project(PolyMesh& mesh, DistanceField& field, const ProjectOptions& options, Monitor& monitor,
             std::vector<StuckNode>* stuck = nullptr);

}  // namespace pm
