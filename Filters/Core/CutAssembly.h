// SPDX-License-Identifier: BSD-3-Clause
// The mesh that a choice of cuts makes: count, prefix sum, fill.
#pragma once

#include "CellCuts.h"

namespace pm {

/// The cut mesh, canonical: old points keep their ids, then come the centres of cells, then those of faces,
/// each in the order of the old ids; new cells are in the order of their old cells. A new cell has its old
/// cell's level, layer and zone, a piece of a boundary face its patch; the centre of a face may not move in
/// the coordinates in which none of its corners may; no point has a base any more. Linear time, parallel.
///
/// Throws BudgetError when the new mesh has more faces or cells than ids can name.
///
/// firstCell: #C+1, the first new cell of each old cell.
PolyMesh assembleCuts(const PolyMesh& mesh, const CellCuts& cuts, Monitor& monitor,
                      std::vector<Id>& firstCell);

}  // namespace pm
