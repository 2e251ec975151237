// SPDX-License-Identifier: BSD-3-Clause
// New nodes where a feature curve found none (thesis 4.7.3, distortion and splitting, with the cell splitting
// of 4.4.2).
//
// Two nodes that follow each other on a curve and share no wall edge leave a gap: the wall between them cuts
// the edge off. A bridge splits the prism columns that the curve crosses there, with new nodes where it
// crosses wall edges, and puts these on the curve. Each bridge is tried out in a copy of the cells around it,
// so that nothing of the mesh changes before it is known to end valid.
//
// Passes: gaps are found along each curve; for each, paths over the wall with at most two new nodes, the
// nearest to the curve first, are tried until one holds; of bridges of which one changes what another has
// looked at, the first is built.
//
// Guarantees: a valid mesh stays valid; points and cells keep their ids; the same bits for any number of
// threads.
#pragma once

#include <array>
#include <functional>
#include <set>

#include "ColumnSplit.h"
#include "DistanceField.h"
#include "FeaturePaths.h"
#include "MeshQuality.h"

namespace pm {

/// What is known of the wall when bridges are built.
struct BridgeSite {
  const WallSurface& wall;
  const DistanceField& field;
  const FeatureGraph& graph;
  const PathHistory& held;  ///< curve and corner of the nodes that lie on one
  const QualityLimits& limits;
  /// Can the one place be seen from the other? Places on the far side of the geometry cannot.
  std::function<bool(const Vec3& from, const Vec3& to)> sees;
};

/// A gap as long as the mesh keeps its points: the curve, and those it lies between.
using GapKey = std::array<Id, 3>;

struct BridgesBuilt {
  std::size_t count = 0;   ///< bridges; one over a single face has no new node
  std::vector<Id> curves;  ///< of each new wall node in ascending order, the curve it lies on
  bool more = false;       ///< what was built may let others hold
};
/// Builds what bridges it can. hopeless: gaps that need not be tried; receives those where none holds, and
/// loses those beside one that was built.
BridgesBuilt bridgeGaps(PolyMesh& mesh, const BridgeSite& site, std::set<GapKey>& hopeless);

}  // namespace pm
