// SPDX-License-Identifier: BSD-3-Clause
// Self-intersections that are found once for a geometry: a change of cell sizes asks for them again and
// again.
#pragma once

#include <memory>

#include "SelfIntersections.h"

namespace pm {

/// What selfIntersections(model) gives, found anew only when the geometry last asked for had other content.
/// Thread-safe. The monitor can stop the search and nothing is kept then.
std::shared_ptr<const SelfIntersections> knownIntersections(const SurfaceModel& model, Monitor& monitor);

}  // namespace pm
