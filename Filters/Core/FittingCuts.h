// SPDX-License-Identifier: BSD-3-Clause
// Wall faces that lie nearer to the geometry when cut in two (thesis 4.7.3; part of ResolveFeatures).
#pragma once

#include <functional>

#include "DistanceField.h"
#include "NodeMover.h"
#include "WallCuts.h"

namespace pm {

/// For every wall face that folds and whose centre is off the geometry: the diagonal whose parts are much
/// nearer to it, judged by their centres and the middle of the diagonal (eq 4-20), if the mesh keeps its
/// limits with it. Ascending by face; the same bits for any number of threads.
std::vector<WallCut> fittingCuts(const NodeMover& mover, const DistanceField& field);

/// Pairs of wall faces that lie no nearer to the geometry than the face they would be together: its cut would
/// not be one of fittingCuts(). Not those whose common edge isOnFeature(a, b), nor those with which the mesh
/// would leave its limits; and no two of one cell or of neighbouring ones, so that all hold together. In the
/// order of wallPairs(); the same bits for any number of threads.
std::vector<WallMerge> needlessCuts(const NodeMover& mover, const DistanceField& field,
                                    const std::function<bool(Id, Id)>& isOnFeature);

/// Each cut holds beside the mesh as it was before; those of neighbouring cells may not hold together. Of
/// cuts that are made, the ones at whose ends the mesh is outside its limits, as merges that undo them.
std::vector<WallMerge> cutsToUndo(const NodeMover& mover, const std::vector<WallCut>& cuts);

}  // namespace pm
