// SPDX-License-Identifier: BSD-3-Clause
// Random valid meshes with a layer of prisms, and moves of their points.
#pragma once

#include "NodeMover.h"

namespace pm::testing {

/// The layer on the front of a random domain that is large enough to have an inside.
PolyMesh layer(unsigned seed);
/// The same when its points are no longer where a rule put them.
PolyMesh shaken(unsigned seed);

std::vector<Id> allPoints(const PolyMesh& mesh);
/// A move of a point that depends on the seed alone: kind 0 takes its base along, if it has one; 1 improve();
/// else drift().
void randomMove(NodeMover& mover, const PolyMesh& mesh, Id p, unsigned seed, unsigned kind);
/// A few moves of every kind of each point, the same for the same mesh.
void sweep(NodeMover& mover, const PolyMesh& mesh, const MoveBlocks& blocks);

}  // namespace pm::testing
