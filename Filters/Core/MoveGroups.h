// SPDX-License-Identifier: BSD-3-Clause
// Which points may move at the same time, and in which order that keeps a processor's cache warm.
#pragma once

#include "MoverRegion.h"

namespace pm {

/// Points in blocks that are small in space, so that one point's move finds in the cache what the last one
/// used; and the blocks in groups whose moves touch nothing in common.
struct MoveBlocks {
  Csr<Id> points;                       // of each block, in the order they move in
  std::vector<std::vector<Id>> groups;  // of blocks
};

/// Groups of rows of points whose moves (a wall point's together with its base) touch nothing in common with
/// those of another row of the group. Greedy, in the order of the rows.
std::vector<std::vector<Id>> groupRows(const PolyMesh& mesh, const MoverRegion& region, const Csr<Id>& rows);
/// Blocks by a grid of a few finest cells; in a block the points keep the order given.
MoveBlocks groupBlocks(const PolyMesh& mesh, const MoverRegion& region, const std::vector<Id>& points);

}  // namespace pm
