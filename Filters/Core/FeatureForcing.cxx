// SPDX-License-Identifier: BSD-3-Clause
// FeatureSnapper's means for nodes that cannot reach their targets by a move of their own: drifting with
// local optimisation (thesis 4.4.1, 4.7.2), and cuts of the faces in the way (4.7.3).
#include <algorithm>
#include <cmath>

#include "FeatureSnapper.h"

namespace pm {

void FeatureSnapper::force() {
  // Corners first: no other place would do for them, and no other node.
  std::vector<Id> all = missed(), rows;
  std::stable_partition(all.begin(), all.end(), [&](Id row) { return role_[row] == Role::Corner; });
  Csr<Id> points;
  for (Id row : all) {
    if (mesh_.base[wall_.nodes[row]] == kNone) continue;
    rows.push_back(row);
    points.push(forced_.points(row));
  }
  ++pass_;
  mover_.forEach(mover_.colourRows(points), [&](Id i) {
    if (stirred(rows[i], forceTried_)) forceNode(rows[i], points[i]);
  });
}

/// Where it fails, neighbours that slid along their curves get their targets back.
void FeatureSnapper::forceNode(Id row, Span<Id> points) {
  if (!canReach(row)) return;
  std::vector<Vec3> targets;  // of nodes that may slide along their curves
  for (Id n : wall_.neighbours[row]) targets.push_back(target_[n]);
  if (forced_.force(row, points, target_[row], [&](Id n) { mendWallNode(n); })) {
    for (Id q : points) changed_[q] = pass_;
    return;
  }
  std::size_t i = 0;
  for (Id n : wall_.neighbours[row]) target_[n] = targets[i++];
}

/// A wall node gives way along the geometry, and along its curve when it lies on one.
void FeatureSnapper::mendWallNode(Id row) {
  if (role_[row] == Role::Corner) return;
  const bool onCurve = role_[row] == Role::Curve && reached(row);
  forced_.mendAlongWall(row, [&](const Vec3& to, double badness) {
    if (!onCurve) return improveNear(row, field_.closest(to).point, badness);
    const ClosestOnFeature on = graph_.closestOnCurve(to, curve_[row]);
    if (on.segment == kNone || crowdsPath(row, on.point) || !improveNear(row, on.point, badness))
      return false;
    target_[row] = mesh_.points[wall_.nodes[row]];
    return true;
  });
}

/// A face's eta with the node at its target, 0 when it folds; ids are places in `at`.
double FeatureSnapper::qualityAt(const std::vector<Vec3>& at, const std::vector<Id>& ids) const {
  const FaceMeasures m = measureFace(at, spanOf(ids));
  return m.warpage() > mover_.limits().maxWarpage ? 0.0 : m.eta;
}

/// The cut that would keep a face around the node from folding or flattening with the node at its target;
/// none when other faces are in the way as well.
WallCut FeatureSnapper::cutFor(Id row) const {
  const double enough = mover_.limits().minEtaBoundary;
  WallCut best;
  int inTheWay = 0;
  std::vector<Vec3> at;
  std::vector<Id> ids, first, second;
  for (Id f : wall_.faces[row]) {
    const Span<Id> ring = mesh_.faces[f];
    const Id n = static_cast<Id>(ring.size());
    at.clear();
    ids.clear();
    for (Id q : ring) {
      ids.push_back(static_cast<Id>(ids.size()));
      at.push_back(q == wall_.nodes[row] ? target_[row] : mesh_.points[q]);
    }
    const double now = qualityAt(at, ids);
    if (now >= enough) continue;
    if (n == 3 || ++inTheWay > 1) return {};  // one cut would not do
    double most = enough;
    for (Id i = 0; i + 2 < n; ++i)
      for (Id j = i + 2; j < n && j < i + n - 1; ++j) {
        cutRow(spanOf(ids), i, j, first, second);
        const double quality = std::min(qualityAt(at, first), qualityAt(at, second));
        const WallCut cut{f, ring[i], ring[j]};
        if (quality < most || !mover_.cutHolds(cut)) continue;
        most = quality;
        best = cut;
      }
  }
  return best;
}

std::vector<WallCut> FeatureSnapper::helpfulCuts() const {
  std::vector<WallCut> cuts;
  for (Id row : missed())
    if (canReach(row))
      if (const WallCut cut = cutFor(row); cut.face != kNone) cuts.push_back(cut);
  return cuts;
}

}  // namespace pm
