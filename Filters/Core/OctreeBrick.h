// SPDX-License-Identifier: BSD-3-Clause
// Where the octree lies and how deep it may go: root cells, levels, and the check of the options.
#pragma once

#include "OctreeDecompose.h"

namespace pm {

/// Throws InputError for options that contradict each other or the geometry.
void checkOptions(const SurfaceModel& model, const OctreeDecomposeOptions& options);

/// Throws InputError for sizes that do not fit the octree's range, BudgetError for too many root cells.
Brick chooseBrick(const SurfaceModel& model, const OctreeDecomposeOptions& options);

/// First level whose cells are at most that large; may exceed the brick's finest.
int levelFor(double rootEdge, double size);
/// The same, at most the brick's finest level.
int levelFor(const Brick& brick, double size);

}  // namespace pm
