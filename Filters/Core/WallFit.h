// SPDX-License-Identifier: BSD-3-Clause
// Fits the wall's faces, not its nodes alone, to the geometry (eq 4-20).
//
// With every node on a curved surface, edges and faces are chords: all of their error lies on one side.
// Shifting the nodes by half of it along the normal halves the largest distance, and the mesh keeps the
// volume of the geometry.
#pragma once

#include <vector>

#include "DistanceField.h"
#include "NodeMover.h"
#include "WallSurface.h"

namespace pm {

/// What a wall node may do in the fit.
enum class FitRole : std::uint8_t {
  Shift,   ///< shift along the normal
  Search,  ///< and look for a better place along the surface: it is near a feature, where faces may stay off
           ///< it
  Keep,    ///< stay: it lies on a feature
};

/// roles: #W, of the rows of `wall`. All but the kept nodes shift, together, to at most 0.045 of the finest
/// cell from the geometry; those near features also search where that leaves a face off the geometry, and
/// stay unless the faces' representative points get nearer to it. The mesh stays valid.
void fitWall(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
             const std::vector<FitRole>& roles);

}  // namespace pm
