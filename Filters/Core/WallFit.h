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

/// Passes: nodes beside faces that are off the geometry search along the surface for a better place; then all
/// shift. keep: #W rows of `wall` whose nodes stay where they are (they lie on features). A shift is at most
/// 0.045 of the finest cell and kept only if it is valid and the faces' representative points get nearer to
/// the geometry.
void fitWall(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
             const std::vector<std::uint8_t>& keep);

}  // namespace pm
