// SPDX-License-Identifier: BSD-3-Clause
// FeatureSnapper's means for nodes that cannot reach their targets by a move of their own: drifting with
// local optimisation (thesis 4.4.1, 4.7.2), and cuts of the faces in the way (4.7.3).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "FeatureSnapper.h"

namespace pm {
namespace {

constexpr int kMendSweeps = 6;
// Badness around a forced node (above 1: invalid) from which on it is given up: at once, and after a sweep.
// Of what is worse, one in fifty comes out valid.
constexpr double kHopeless = 4, kHopelessMended = 1.5;
constexpr double kMendSteps[] = {0.3, 0.12};  // length scales

Span<Id> spanOf(const std::vector<Id>& ids) { return {ids.data(), ids.data() + ids.size()}; }

}  // namespace

/// A place for the lower end of the prism edge from `to`, near where it is, that makes the side faces around
/// the edge flat: the least sum of squares of distances from their planes.
Vec3 FeatureSnapper::flatBase(Id row, const Vec3& to) const {
  constexpr double kStay = 0.1;  // weight of staying against that of one side face
  const Vec3& low = mesh_.points[mesh_.base[wall_.nodes[row]]];
  Eigen::Matrix3d sum = kStay * Eigen::Matrix3d::Identity();
  Vec3 rhs = Vec3::Zero();
  for (Id n : wall_.neighbours[row]) {
    const Id q = wall_.nodes[n], below = mesh_.base[q];
    if (below == kNone) continue;
    const Vec3 normal = (mesh_.points[q] - to).cross(mesh_.points[below] - to).stableNormalized();
    sum += normal * normal.transpose();
    rhs += normal * normal.dot(to - low);
  }
  return low + sum.ldlt().solve(rhs);
}

/// The points that may move when a node is forced to its target: its column first, then the columns of its
/// wall neighbours, then what lies around its base.
std::vector<Id> FeatureSnapper::mendingPoints(Id row) const {
  const Id p = wall_.nodes[row], b = mesh_.base[p];
  std::vector<Id> points{p, b}, around;
  for (Id n : wall_.neighbours[row]) points.push_back(wall_.nodes[n]);
  for (Id n : wall_.neighbours[row])
    if (mesh_.base[wall_.nodes[n]] != kNone) around.push_back(mesh_.base[wall_.nodes[n]]);
  for (Id f : mover_.facesOf(b))
    for (Id q : mesh_.faces[f])
      if (wall_.rowOf[q] == kNone && q != b) around.push_back(q);
  sortUnique(around);
  points.insert(points.end(), around.begin(), around.end());
  return points;
}

void FeatureSnapper::force() {
  std::vector<Id> rows;
  Csr<Id> points;
  for (Id row : missed()) {
    if (mesh_.base[wall_.nodes[row]] == kNone) continue;
    rows.push_back(row);
    points.push(mendingPoints(row));
  }
  ++pass_;
  mover_.forEach(mover_.colourRows(points), [&](Id i) {
    if (stirred(rows[i], forceTried_)) forceNode(rows[i], points[i]);
  });
}

/// The node goes where it shall whatever breaks; then the points around it give way, step by step.
void FeatureSnapper::forceNode(Id row, Span<Id> points) {
  const Id p = points[0], b = points[1];
  const Vec3 to = target_[row];
  if (!canReach(row)) return;
  std::vector<Vec3> targets;  // of nodes that may slide along their curves
  for (Id n : wall_.neighbours[row]) targets.push_back(target_[n]);
  NodeMover::Trial trial(mover_);
  trial.force({p, b}, {to, flatBase(row, to)});
  const auto badness = [&] { return std::max(mover_.badness(p), mover_.badness(b)); };
  double last = badness();
  for (int sweep = 0; sweep < kMendSweeps && last < kHopeless; ++sweep) {
    mendInner(b, flatBase(row, to), wall_.scale[row]);
    for (Id q : Span<Id>{points.first + 2, points.last}) {
      if (wall_.rowOf[q] != kNone)
        mendWallNode(wall_.rowOf[q]);
      else
        mendInner(q, neighbourMean(q), wall_.scale[row]);
    }
    const double bad = badness();
    if (bad <= 1 || bad > std::min(0.98 * last, kHopelessMended)) break;
    last = bad;
  }
  if (trial.settle()) {
    for (Id q : points) changed_[q] = pass_;
    return;
  }
  std::size_t i = 0;
  for (Id n : wall_.neighbours[row]) target_[n] = targets[i++];
}

/// Tries places around a point that make the worst measure there better, until all are within their limits.
void FeatureSnapper::mendInner(Id point, const Vec3& ideal, double scale) {
  double bad = mover_.badness(point);
  const auto attempt = [&](const Vec3& to) {
    if (bad > 1 && mover_.improve(point, to, bad)) bad = mover_.badness(point);
  };
  attempt(ideal);
  attempt(0.5 * (ideal + mesh_.points[point]));
  for (double step : kMendSteps)
    for (int k = 0; k < 6; ++k) {
      Vec3 to = mesh_.points[point];
      to[k / 2] += (k % 2 ? step : -step) * scale;
      attempt(to);
    }
}

/// The same along the geometry, and along its curve for a node that lies on one.
void FeatureSnapper::mendWallNode(Id row) {
  const Id p = wall_.nodes[row];
  double bad = mover_.badness(p);
  if (bad <= 1 || role_[row] == Role::Corner) return;
  const Vec3 n = wallNormal(row);
  if (!(n.norm() > 0)) return;
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const bool onCurve = role_[row] == Role::Curve && reached(row);
  for (double step : kMendSteps)
    for (int k = 0; k < 6 && bad > 1; ++k) {
      const double angle = k * 3.14159265358979323846 / 3;
      Vec3 to = mesh_.points[p] + step * wall_.scale[row] * (std::cos(angle) * u + std::sin(angle) * v);
      if (onCurve) {
        const ClosestOnFeature on = graph_.closestOnCurve(to, curve_[row]);
        if (on.segment == kNone || crowdsPath(row, on.point)) continue;
        to = on.point;
      } else {
        to = field_.closest(to).point;
      }
      if (!improveNear(row, to, bad)) continue;
      bad = mover_.badness(p);
      if (onCurve) target_[row] = mesh_.points[p];
    }
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
