// SPDX-License-Identifier: BSD-3-Clause
#include "LayerSearch.h"

#include <algorithm>

namespace pm {
namespace {

constexpr int kSearches = 6;             // for one column
constexpr double kLeans[] = {0.4, 0.2};  // to each side, over the edge's length
// What a change must bring, where a face just beyond its limit costs 1; layers lower than wanted must mend
// more.
constexpr double kGain = 0.001, kThinGain = 0.5;

/// Places for the lower end of an edge: below the wall point where all of the wall is seen, nearer and
/// farther on the edge, and to all sides.
std::vector<Vec3> places(const Vec3& wall, const Vec3& lower, const Vec3& best) {
  constexpr double kLengths[] = {1, 0.6, 1.5}, kParts[] = {1, 0.5}, kScales[] = {0.7, 1.5}, kAside = 0.25;
  const Vec3 edge = lower - wall;
  const double length = edge.norm();
  std::vector<Vec3> list;
  for (double l : kLengths)
    for (double part : kParts) list.push_back(lower + part * (wall + l * length * best - lower));
  for (double scale : kScales) list.push_back(wall + scale * edge);
  for (int axis = 0; axis < 3; ++axis)
    for (double side : {-kAside, kAside}) list.push_back(lower + side * length * Vec3::Unit(axis));
  return list;
}

}  // namespace

LayerSearch::LayerSearch(PolyMesh& mesh, LayerColumns& columns, LayerPoints& points, const WallSight& sight,
                         LayerCheck& check, const QualityLimits& limits, const std::vector<Id>& mendable,
                         const Monitor& monitor)
    : mesh_(mesh),
      columns_(columns),
      points_(points),
      sight_(sight),
      check_(check),
      mover_(mesh, limits, lowerEnds(columns, mendable), &monitor) {
  searches_.assign(columns.count(), 0);
  changed_.assign(mesh.points.size(), 0);
}

std::vector<Id> LayerSearch::lowerEnds(const LayerColumns& columns, const std::vector<Id>& mendable) {
  std::vector<Id> ends;
  for (Id c : mendable) ends.insert(ends.end(), columns.ring(c).begin(), columns.ring(c).end());
  sortUnique(ends);
  return ends;
}

std::vector<Id> LayerSearch::mend(const std::vector<Id>& faulty) {
  std::vector<Id> todo;
  for (Id c : faulty) {
    const Span<Id> ring = columns_.ring(c);
    const bool mayMove = std::all_of(ring.begin(), ring.end(), [&](Id b) { return mover_.isMovable(b); });
    if (!mayMove || searches_[c] == kSearches) continue;
    ++searches_[c];
    todo.push_back(c);
  }
  Csr<Id> rings;
  for (Id c : todo) rings.push(columns_.ring(c));
  mover_.forEach(mover_.colourRows(rings), [&](Id i) { mendColumn(todo[i]); });
  std::vector<Id> around;
  for (Id b : rings.values) {
    if (changed_[b]) around.insert(around.end(), columns_.columnsOf(b).begin(), columns_.columnsOf(b).end());
    changed_[b] = 0;
  }
  sortUnique(around);
  return around;
}

/// Edges that see their wall worst first, until the column has no fault.
void LayerSearch::mendColumn(Id column) {
  const std::vector<Id> own(1, column);
  std::vector<Id> ring(columns_.ring(column).begin(), columns_.ring(column).end());
  const auto cosine = [&](Id b) {
    const Id p = columns_.wallPoint(b);
    return sight_.cosine(p, mesh_.points[b] - mesh_.points[p]);
  };
  std::stable_sort(ring.begin(), ring.end(), [&](Id a, Id b) { return cosine(a) < cosine(b); });
  LayerTrial trial = check_.trial();
  for (Id b : ring) {
    trial.gather(own);
    if (trial.cost() == 0) return;
    mendEdge(b, trial);
  }
}

void LayerSearch::mendEdge(Id lower, LayerTrial& trial) {
  const std::vector<Id> around(columns_.columnsOf(lower).begin(), columns_.columnsOf(lower).end());
  trial.gather(around, lower);
  double cost = trial.cost();
  if (cost > 0) cost = tryCourses(lower, 0, LayerPoints::kFullCourses, around, trial, cost);
  if (cost > 0 && !columns_.isPinched(lower)) cost = tryLeans(lower, trial, cost);
  if (cost > 0 && movesEnds_) cost = tryPlaces(lower, trial, cost);
  if (cost > 0) tryCourses(lower, LayerPoints::kFullCourses, LayerPoints::kCourses, around, trial, cost);
  trial.cost();  // brings the centres up to date
}

double LayerSearch::tryCourses(Id lower, int first, int last, const std::vector<Id>& around,
                               LayerTrial& trial, double cost) {
  const int old = points_.course(lower);
  int best = old;
  const auto take = [&](int course) {
    const bool pinched = columns_.isPinched(lower);
    if (!points_.setCourse(lower, course)) return false;
    if (columns_.isPinched(lower) != pinched) trial.gather(around, lower);
    return true;
  };
  const double gain = first < LayerPoints::kFullCourses ? kGain : kThinGain;
  for (int course = first; course < last && cost > 0; ++course) {
    if (course == old || !take(course)) continue;
    const double now = trial.cost(cost - gain);
    if (now > cost - gain) continue;
    cost = now;
    best = course;
  }
  take(best);
  if (best != old) changed_[lower] = 1;
  return cost;
}

double LayerSearch::tryLeans(Id lower, LayerTrial& trial, double cost) {
  const Vec3 old = points_.lean(lower);
  for (double step : kLeans) {
    const Vec3 from = points_.lean(lower);
    Vec3 best = from;
    for (int axis = 0; axis < 3; ++axis) {
      for (double side : {-step, step}) {
        if (cost == 0) break;
        const Vec3 lean = from + side * Vec3::Unit(axis);
        points_.setLean(lower, lean);
        const double now = trial.cost(cost - kGain);
        if (now > cost - kGain) continue;
        cost = now;
        best = lean;
      }
    }
    points_.setLean(lower, best);
  }
  if (points_.lean(lower) != old) changed_[lower] = 1;
  return cost;
}

double LayerSearch::tryPlaces(Id lower, LayerTrial& trial, double cost) {
  const Vec3 old = mesh_.points[lower];
  const Id wall = columns_.wallPoint(lower);
  Vec3 best = old;
  for (const Vec3& place : places(mesh_.points[wall], old, sight_.best(wall))) {
    if (cost == 0) break;
    if (!moveTo(lower, place)) continue;
    const double now = trial.cost(cost - kGain);
    if (now < cost - kGain) {
      cost = now;
      best = mesh_.points[lower];
    }
  }
  if (!moveTo(lower, best)) {
    moveTo(lower, old);
    moveTo(lower, best);
  }
  if (mesh_.points[lower] != old) changed_[lower] = 1;
  return cost;
}

bool LayerSearch::moveTo(Id lower, const Vec3& to) {
  if (!mover_.move(lower, to)) return false;
  points_.follow(lower);
  for (Id c : mover_.cellsOf(lower))
    if (columns_.columnOf(c) == kNone) check_.measureBeside(c);
  return true;
}

}  // namespace pm
