// SPDX-License-Identifier: BSD-3-Clause
// New nodes in wall edges that are chords of the geometry (thesis 4.4.2, edge splitting on the boundary
// layer).
//
// An edge between two nodes on a tight round, or on a feature that bends between them, leaves the geometry in
// its middle however well its ends lie. It gets a node there, which goes to the curve both ends lie on or
// else to the geometry; the side face below is cut in two, and the columns beside it get one side more.
//
// Passes: chords are found; those whose cells touch are a group; each group is tried out in a copy of the
// cells around it, first with the columns between two new nodes split as well, for then their wall faces
// follow the geometry too. What does not end valid is tried more modestly, and left out in the end.
//
// Guarantees: a valid mesh stays valid; points and cells keep their ids, new ones come behind; the same bits
// for any number of threads.
#pragma once

#include "FeatureBridges.h"

namespace pm {

/// Returns of each new wall node, in ascending order, the curve it lies on; kNone for none.
std::vector<Id> splitChords(PolyMesh& mesh, const BridgeSite& site);

}  // namespace pm
