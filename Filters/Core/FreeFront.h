// SPDX-License-Identifier: BSD-3-Clause
// Where the front is to go: the wall smoothed and led to the geometry as a surface by itself, without the
// cells below (thesis 4.5.1, 4.5.2, 4.6.2).
//
// The cells are what makes a move costly; without them, a sweep over the front costs a hundredth. Nothing
// here is checked: the places are goals, and whoever moves the nodes there keeps the mesh valid.
#pragma once

#include <functional>
#include <vector>

#include "Monitor.h"
#include "WallSurface.h"

namespace pm {

/// From a place where the wall node of a row could be to the geometry.
using WayToGeometry = std::function<Vec3(Id row, const Vec3& from)>;

/// #W the place for each wall node. Fixed coordinates stay. Stops soon after an abort (AbortError).
std::vector<Vec3> freeFront(const PolyMesh& mesh, const WallSurface& wall, const WayToGeometry& way,
                            Monitor& monitor);

}  // namespace pm
