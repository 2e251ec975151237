// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: wall nodes drift onto the geometry, valid at every move (thesis 4.4.1, 4.5, 4.6.2).
#pragma once

#include "DistanceField.h"
#include "MeshQuality.h"

namespace pm {

struct ProjectOptions {
  int rounds = 8;  ///< drifting rounds; each moves a node a growing part of its way
  QualityLimits limits;
};

void project(PolyMesh& mesh, DistanceField& field, const ProjectOptions& options, Monitor& monitor);

}  // namespace pm
