// SPDX-License-Identifier: BSD-3-Clause
// Joins the free leaves of a place too thin for them to hang together by faces.
//
// In a sheet or gap of two to three leaves whose walls are oblique, whole leaves fit here and there only, and
// whether one lies beside the next is chance. Painting alone (thesis 3.4.2) takes them for regions of their
// own, and the mesh is torn where they are. A cut leaf links two such sets when the way through it, from a
// leaf of one to a leaf of the other across its faces, keeps half a leaf away from the geometry, as ways
// through free leaves do; so no hole narrower than a leaf is passed. That is so where its centre and the
// middles of the two faces are 1/sqrt(3) of its edge away: of two balls of that radius half an edge apart,
// one holds the ball of half an edge about any point between. And no triangle may lie between its centre and
// that of any leaf of theirs beside it.
//
// Sets are joined while at most one of them is a room: has a leaf with free leaves on all sides, or reaches
// the sides of the octree. So a link never leads from one room to another, nor out.
#pragma once

#include "Octree.h"
#include "SurfaceModel.h"

namespace pm {

/// setOf: #L face-connected set of each free leaf, numbered by their smallest leaves; kNone for the cut ones.
/// Afterwards joined sets have one number, which the leaves that link them have, too; numbered as before.
/// Same result for any number of threads.
void joinThinPlaces(const Octree& tree, const SurfaceModel& model, std::vector<Id>& setOf);

}  // namespace pm
