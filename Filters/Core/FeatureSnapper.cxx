// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureSnapper.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace pm {
namespace {

constexpr int kRings = 2;           // wall nodes this many edges from a target take part in the smoothing
constexpr int kDistanceGroups = 4;  // eq 4-31
// In length scales: what counts as reached, what is not worth a move on from there, and how near the nodes of
// a path may come.
constexpr double kReached = 1e-3, kThere = 1e-6;
constexpr double kCrowded = 0.2;
constexpr double kFine = 0.9;  // badness below which cells are well enough not to be worth another try

}  // namespace

std::vector<double> prismHeights(const PolyMesh& mesh, const WallSurface& wall) {
  std::vector<double> heights;
  for (Id p : wall.nodes)
    heights.push_back(mesh.base[p] == kNone ? 0.0 : (mesh.points[p] - mesh.points[mesh.base[p]]).norm());
  return heights;
}

FeatureSnapper::FeatureSnapper(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
                               const FeatureGraph& graph, const std::vector<double>& height)
    : mover_(mover),
      mesh_(mover.mesh()),
      wall_(wall),
      field_(field),
      graph_(graph),
      height_(height),
      forced_(mover, wall) {
  changed_.assign(mesh_.points.size(), 1);
  innerTried_.assign(mesh_.points.size(), 0);
  relaxTried_.assign(wall.nodes.size(), 0);
  snapTried_ = forceTried_ = relaxTried_;
  wentBack_.assign(mesh_.points.size(), 0);
  isBase_.assign(mesh_.points.size(), 0);
  for (Id p : wall.nodes)
    if (mesh_.base[p] != kNone) isBase_[mesh_.base[p]] = 1;
}

void FeatureSnapper::setTargets(const FeaturePaths& paths) {
  const std::size_t n = wall_.nodes.size();
  const std::vector<Role> roleBefore = std::exchange(role_, std::vector<Role>(n, Role::Outside));
  const std::vector<Vec3> targetBefore = std::exchange(target_, std::vector<Vec3>(n, Vec3::Zero()));
  curve_.assign(n, kNone);
  corner_.assign(n, kNone);
  before_.assign(n, kNone);
  after_.assign(n, kNone);
  for (const NodeTarget& t : paths.targets) {
    const Id row = wall_.rowOf[t.node];
    role_[row] = t.corner == kNone ? Role::Curve : Role::Corner;
    target_[row] = t.target;
    curve_[row] = t.curve;
    corner_[row] = t.corner;
  }
  // What failed fails again unless something has changed.
  for (std::size_t row = 0; row < roleBefore.size(); ++row)
    if (role_[row] != roleBefore[row] || target_[row] != targetBefore[row])
      snapTried_[row] = forceTried_[row] = 0;
  for (Id i = 0; i < paths.pieces.rows(); ++i) {
    const Span<Id> piece = paths.pieces[i];
    for (std::size_t k = 0; k + 1 < piece.size(); ++k) {
      const Id a = wall_.rowOf[piece[k]], b = wall_.rowOf[piece[k + 1]];
      after_[a] = b;
      before_[b] = a;
    }
  }
}

void FeatureSnapper::noteChange(Span<Id> points) {
  for (Id p : points) changed_[p] = pass_;
}

void FeatureSnapper::workAroundAll() {
  std::vector<Id> rows;
  for (Id row = 0; row < wall_.size(); ++row)
    if (role_[row] == Role::Curve || role_[row] == Role::Corner) rows.push_back(row);
  workAround(rows);
}

void FeatureSnapper::workAround(std::vector<Id> rows) {
  std::vector<char> seen(wall_.nodes.size(), 0);
  for (Id row : rows) seen[row] = 1;
  std::vector<Id> ring = rows;
  for (int r = 0; r < kRings; ++r) {
    std::vector<Id> next;
    for (Id row : ring)
      for (Id n : wall_.neighbours[row])
        if (!seen[n]) {
          seen[n] = 1;
          if (role_[n] == Role::Outside) role_[n] = Role::Free;
          next.push_back(n);
        }
    rows.insert(rows.end(), next.begin(), next.end());
    ring.swap(next);
  }
  std::sort(rows.begin(), rows.end());
  active_ = rows;
  inner_.clear();
  for (Id row : rows) {
    const Id b = mesh_.base[wall_.nodes[row]];
    if (b == kNone) continue;
    for (Id f : mover_.facesOf(b))
      for (Id p : mesh_.faces[f])
        if (wall_.rowOf[p] == kNone && !isBase_[p]) inner_.push_back(p);
  }
  sortUnique(inner_);
}

/// Groups of wall nodes whose columns may move in parallel.
std::vector<std::vector<Id>> FeatureSnapper::columnGroups(const std::vector<Id>& rows) const {
  std::vector<Id> points;
  points.reserve(rows.size());
  for (Id row : rows) points.push_back(wall_.nodes[row]);
  return mover_.colour(points);
}

template <class Body>
void FeatureSnapper::forEachRow(const std::vector<std::vector<Id>>& groups, const Body& body) {
  mover_.forEach(groups, [&](Id point) { body(wall_.rowOf[point]); });
}

/// Has anything in the columns at and around a row moved since the last attempt? Notes a new attempt if so.
bool FeatureSnapper::stirred(Id row, std::vector<Id>& tried) {
  const auto column = [&](Id r) {
    const Id p = wall_.nodes[r], b = mesh_.base[p];
    return std::max(changed_[p], b == kNone ? 0 : changed_[b]);
  };
  Id last = column(row);
  for (Id n : wall_.neighbours[row]) last = std::max(last, column(n));
  if (last < tried[row]) return false;
  tried[row] = pass_;
  return true;
}

bool FeatureSnapper::stirredBelow(Id point) {
  Id last = 0;
  for (Id f : mover_.facesOf(point))
    for (Id p : mesh_.faces[f]) last = std::max(last, changed_[p]);
  if (last < innerTried_[point]) return false;
  innerTried_[point] = pass_;
  return true;
}

double FeatureSnapper::distance(Id row) const {
  return (target_[row] - mesh_.points[wall_.nodes[row]]).norm() / wall_.scale[row];
}

/// Would the wall around the node stay near the geometry with the node at its target?
bool FeatureSnapper::canReach(Id row) const {
  return staysNear(row, mesh_.points[wall_.nodes[row]], target_[row], kSnapTolerance * wall_.scale[row]);
}

bool FeatureSnapper::reached(Id row) const { return distance(row) <= kReached; }

std::vector<Id> FeatureSnapper::missed() const {
  std::vector<Id> rows;
  for (Id row = 0; row < wall_.size(); ++row)
    if ((role_[row] == Role::Curve || role_[row] == Role::Corner) && !reached(row)) rows.push_back(row);
  return rows;
}

void FeatureSnapper::report(PathHistory& history) const {
  constexpr float kMissPenalty = 1;  // length scales: as much as the detour of an edge
  const std::size_t n = wall_.nodes.size();
  history.penalty.resize(n, 0.0f);
  history.curve.assign(n, kNone);
  history.corner.assign(n, kNone);
  for (Id row = 0; row < wall_.size(); ++row) {
    if (role_[row] != Role::Curve && role_[row] != Role::Corner) continue;
    if (reached(row)) {
      history.curve[row] = curve_[row];
      history.corner[row] = corner_[row];
    } else {
      history.penalty[row] += kMissPenalty;
    }
  }
}

std::vector<MissedTarget> FeatureSnapper::releaseMissed() {
  std::vector<MissedTarget> given;
  for (Id row : missed()) {
    Refusal limit = Refusal::Other;
    if (canReach(row)) limit = mover_.tryMove(wall_.nodes[row], target_[row]);
    if (limit == Refusal::None) continue;  // room was made for it since the last attempt
    given.push_back({row, curve_[row], corner_[row], limit});
    role_[row] = Role::Free;
  }
  return given;
}

void FeatureSnapper::snap(bool corners) {
  const Role role = corners ? Role::Corner : Role::Curve;
  std::vector<Id> open;
  double farthest = 0;
  for (Id row = 0; row < wall_.size(); ++row)
    if (role_[row] == role && distance(row) > kThere) {
      open.push_back(row);
      farthest = std::max(farthest, distance(row));
    }
  std::vector<std::vector<Id>> groups(kDistanceGroups);
  for (Id row : open) {
    const int g = static_cast<int>(distance(row) / farthest * kDistanceGroups);
    groups[std::min(g, kDistanceGroups - 1)].push_back(row);
  }
  for (const std::vector<Id>& group : groups) {
    ++pass_;
    forEachRow(columnGroups(group), [&](Id row) {
      if (stirred(row, snapTried_)) snapNode(row);
    });
  }
}

/// The target, else another point of the curve between the neighbours on the path, else part of the way.
void FeatureSnapper::snapNode(Id row) {
  const Vec3 from = mesh_.points[wall_.nodes[row]];
  if (tryMove(row, target_[row], kSnapTolerance)) return;
  if (role_[row] == Role::Curve) {
    for (double part : {0.0, 0.5}) {
      const ClosestOnFeature on = graph_.closestOnCurve(from + part * (target_[row] - from), curve_[row]);
      if (on.segment == kNone || crowdsPath(row, on.point) || !tryMove(row, on.point, kSnapTolerance))
        continue;
      target_[row] = on.point;
      return;
    }
  }
  for (double part : {0.5, 0.25}) {
    const Vec3 between = field_.closest(from + part * (target_[row] - from)).point;
    if ((between - target_[row]).norm() < (from - target_[row]).norm() &&
        tryMove(row, between, kDriftTolerance))
      return;
  }
}

/// Would the node come too near to its neighbours on the path?
bool FeatureSnapper::crowdsPath(Id row, const Vec3& at) const {
  for (Id n : {before_[row], after_[row]})
    if (n != kNone && (target_[n] - at).norm() < kCrowded * wall_.scale[row]) return true;
  return false;
}

/// Moves a wall node and, as far as it helps, the lower end of its prism edge.
bool FeatureSnapper::tryMove(Id row, const Vec3& to, double tolerance) {
  const Id p = wall_.nodes[row], b = mesh_.base[p];
  const Vec3 from = mesh_.points[p];
  // Asked late, for it costs most, and once.
  std::optional<bool> isNear;
  const auto accept = [&] {
    if (!isNear) isNear = staysNear(row, from, to, tolerance * wall_.scale[row]);
    return *isNear;
  };
  bool kept = false;
  if (b != kNone) {
    const Vec3 low = mesh_.points[b];
    for (const Vec3& at : {Vec3(low + 0.5 * (to - from)), Vec3(low + to - from), forced_.flatBase(row, to)}) {
      kept = mover_.moveTogetherIf({p, b}, {to, at}, accept);
      if (isNear == false) return false;
      if (!kept) continue;
      changed_[b] = pass_;
      break;
    }
  }
  kept = kept || mover_.moveIf(p, to, accept);
  if (kept) changed_[p] = pass_;
  return kept;
}

/// Moves a wall node if that betters the worst measure around it, now `badness`, and no face leaves the
/// geometry.
bool FeatureSnapper::improveNear(Id row, const Vec3& to, double badness) {
  const Id p = wall_.nodes[row];
  const Vec3 from = mesh_.points[p];
  return mover_.improveIf(p, to, badness,
                          [&] { return staysNear(row, from, to, kSmoothTolerance * wall_.scale[row]); });
}

/// Were the node at `to`, would the representative points that follow it be within the limit of the geometry,
/// or no farther than with it at `from`?
bool FeatureSnapper::staysNear(Id row, const Vec3& from, const Vec3& to, double limit) const {
  const double there = deviation(row, to, limit);
  return there <= limit || there <= deviation(row, from, there);
}

/// Largest distance to the geometry of the representative points that follow the node, were it there. Below
/// `enough` it may come out smaller: it is not looked for then.
double FeatureSnapper::deviation(Id row, const Vec3& at, double enough) const {
  const Id p = wall_.nodes[row];
  const SurfaceModel& model = field_.model();
  Closest near = field_.closest(at);
  double worst = std::sqrt(near.distance2);
  const auto add = [&](const Vec3& point) {
    near = model.closest(point, near, enough);
    if (const double distance = std::sqrt(near.distance2); distance >= enough)
      worst = std::max(worst, distance);
  };
  for (Id n : wall_.neighbours[row]) add(0.5 * (at + mesh_.points[wall_.nodes[n]]));
  for (Id f : wall_.faces[row]) {
    Vec3 sum = at;
    for (Id q : mesh_.faces[f])
      if (q != p) sum += mesh_.points[q];
    add(sum / static_cast<double>(mesh_.faces[f].size()));
  }
  return worst;
}

/// Smoothing along the geometry (4.5.2): in the node's tangent plane, then back to the surface. Where it is
/// when that is not worth a move.
Vec3 FeatureSnapper::smoothedNode(Id row) const {
  const Vec3& from = mesh_.points[wall_.nodes[row]];
  Vec3 mean = Vec3::Zero();
  for (Id n : wall_.neighbours[row]) mean += mesh_.points[wall_.nodes[n]];
  mean /= static_cast<double>(wall_.neighbours[row].size());
  const Vec3 n = mover_.meanNormal(wall_.faces[row]);
  Vec3 step = mean - from;
  step -= n.dot(step) * n;
  const Vec3 to = field_.closest(from + 0.5 * step).point;
  return (to - from).norm() < 0.01 * wall_.scale[row] ? from : to;
}

/// A node that reached its curve may slide between its neighbours on the path when that helps the cells
/// around it.
void FeatureSnapper::slideOnCurve(Id row) {
  if (before_[row] == kNone || after_[row] == kNone || !reached(row)) return;
  const Id p = wall_.nodes[row];
  const Vec3 &a = mesh_.points[wall_.nodes[before_[row]]], &b = mesh_.points[wall_.nodes[after_[row]]];
  const ClosestOnFeature on = graph_.closestOnCurve(0.5 * mesh_.points[p] + 0.25 * (a + b), curve_[row]);
  const double limit = kSmoothTolerance * wall_.scale[row];
  if (on.segment == kNone || (on.point - mesh_.points[p]).norm() < 0.5 * limit) return;
  if (!improveNear(row, on.point, mover_.badness(p))) return;
  target_[row] = mesh_.points[p];
  changed_[p] = pass_;
}

/// Lower end of a prism edge with its wall node at `top`: half the way to below it along the wall's normal at
/// the old height, evened out (4.5.3). Where it is when that is not worth a move.
Vec3 FeatureSnapper::settledBase(Id row, const Vec3& top) const {
  const Id b = mesh_.base[wall_.nodes[row]];
  const Vec3 upright = top - height_[row] * mover_.meanNormal(wall_.faces[row]);
  const Vec3 ideal = 0.7 * upright + 0.3 * mover_.neighbourMean(b);
  const Vec3 step = 0.5 * (ideal - mesh_.points[b]);
  return step.norm() < 0.01 * height_[row] ? mesh_.points[b] : Vec3(mesh_.points[b] + step);
}

/// Volume smoothing (4.5.1) of the points below the columns.
void FeatureSnapper::smoothInner() {
  ++pass_;
  std::vector<Id> poor;
  for (Id p : inner_)
    if (stirredBelow(p) && mover_.badness(p) >= kFine) poor.push_back(p);
  mover_.forEach(mover_.colour(poor), [&](Id p) {
    const double badness = mover_.badness(p);
    if (badness < kFine) return;
    const Vec3 to = 0.5 * (mesh_.points[p] + mover_.neighbourMean(p));
    if (mover_.improve(p, to, badness)) changed_[p] = pass_;
  });
}

void FeatureSnapper::relax() {
  ++pass_;
  std::vector<Id> rows;
  for (Id row : active_)
    if (stirred(row, relaxTried_)) rows.push_back(row);
  relaxAll(rows);
  ++pass_;
  const auto isBack = [&](Id row) {
    const Id p = wall_.nodes[row], b = mesh_.base[p];
    return wentBack_[p] || (b != kNone && wentBack_[b]);
  };
  rows.erase(std::remove_if(rows.begin(), rows.end(), [&](Id row) { return !isBack(row); }), rows.end());
  forEachRow(columnGroups(rows), [&](Id row) {
    const Id p = wall_.nodes[row], b = mesh_.base[p];
    if (b != kNone && wentBack_[b] && mover_.drift(b, settledBase(row, mesh_.points[p]), 1) > 0)
      changed_[b] = pass_;
    if (wentBack_[p]) tryMove(row, smoothedNode(row), kSmoothTolerance);
  });
  smoothInner();
}

/// All columns at once; notes the points that did not get there.
void FeatureSnapper::relaxAll(const std::vector<Id>& rows) {
  std::vector<Id> points(2 * rows.size(), kNone);
  std::vector<Vec3> targets(points.size(), Vec3::Zero());
  tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t i) {
    const Id row = rows[i], p = wall_.nodes[row], b = mesh_.base[p];
    const Vec3 from = mesh_.points[p];
    const auto add = [&](std::size_t k, Id point, const Vec3& to) {
      if (to != mesh_.points[point]) points[k] = point, targets[k] = to;
    };
    Vec3 to = role_[row] == Role::Free ? smoothedNode(row) : from;
    if (to != from && !staysNear(row, from, to, kSmoothTolerance * wall_.scale[row])) to = from;
    add(2 * i, p, to);
    if (b != kNone) add(2 * i + 1, b, settledBase(row, to));
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i] != kNone) points[count] = points[i], targets[count++] = targets[i];
  points.resize(count);
  targets.resize(count);
  const std::vector<float> part = mover_.moveAll(points, std::move(targets));
  std::fill(wentBack_.begin(), wentBack_.end(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (part[i] > 0) changed_[points[i]] = pass_;
    wentBack_[points[i]] = part[i] < 1;
  }
}

void FeatureSnapper::polish() {
  const auto columns = columnGroups(active_);
  ++pass_;
  forEachRow(columns, [&](Id row) {
    const double badness = mover_.badness(wall_.nodes[row]);
    if (badness < kFine) return;
    if (role_[row] == Role::Free)
      improveNear(row, smoothedNode(row), badness);
    else if (role_[row] == Role::Curve)
      slideOnCurve(row);
  });
  ++pass_;
  forEachRow(columns, [&](Id row) {
    const Id p = wall_.nodes[row], b = mesh_.base[p];
    if (b == kNone) return;
    const double badness = mover_.badness(b);
    if (badness >= kFine && mover_.improve(b, settledBase(row, mesh_.points[p]), badness))
      changed_[b] = pass_;
  });
  smoothInner();
}

}  // namespace pm
