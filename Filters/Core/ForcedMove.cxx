// SPDX-License-Identifier: BSD-3-Clause
#include "ForcedMove.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr int kMendSweeps = 6;
// Badness around a forced node (above 1: invalid) from which on it is given up: at once, and after a sweep.
// Of what is worse, one in fifty comes out valid.
constexpr double kHopeless = 4, kHopelessMended = 1.5;
constexpr double kMendSteps[] = {0.3, 0.12};  // length scales

}  // namespace

Vec3 ForcedMove::flatBase(Id row, const Vec3& to) const {
  constexpr double kStay = 0.1;  // weight of staying against that of one side face
  const PolyMesh& mesh = mover_.mesh();
  const Vec3& low = mesh.points[mesh.base[wall_.nodes[row]]];
  Eigen::Matrix3d sum = kStay * Eigen::Matrix3d::Identity();
  Vec3 rhs = Vec3::Zero();
  for (Id n : wall_.neighbours[row]) {
    const Id q = wall_.nodes[n], below = mesh.base[q];
    if (below == kNone) continue;
    const Vec3 normal = (mesh.points[q] - to).cross(mesh.points[below] - to).stableNormalized();
    sum += normal * normal.transpose();
    rhs += normal * normal.dot(to - low);
  }
  return low + sum.ldlt().solve(rhs);
}

std::vector<Id> ForcedMove::points(Id row) const {
  const PolyMesh& mesh = mover_.mesh();
  const Id p = wall_.nodes[row], b = mesh.base[p];
  std::vector<Id> points{p, b}, around;
  for (Id n : wall_.neighbours[row]) points.push_back(wall_.nodes[n]);
  for (Id n : wall_.neighbours[row])
    if (mesh.base[wall_.nodes[n]] != kNone) around.push_back(mesh.base[wall_.nodes[n]]);
  for (Id f : mover_.facesOf(b))
    for (Id q : mesh.faces[f])
      if (wall_.rowOf[q] == kNone && q != b) around.push_back(q);
  sortUnique(around);
  points.insert(points.end(), around.begin(), around.end());
  return points;
}

bool ForcedMove::force(Id row, Span<Id> points, const Vec3& to, const MendWall& mendWall) const {
  const Id p = points[0], b = points[1];
  NodeMover::Trial trial(mover_);
  trial.force({p, b}, {to, flatBase(row, to)});
  const auto badness = [&] { return std::max(mover_.badness(p), mover_.badness(b)); };
  double last = badness();
  for (int sweep = 0; sweep < kMendSweeps && last < kHopeless; ++sweep) {
    mendInner(b, flatBase(row, to), wall_.scale[row]);
    for (Id q : Span<Id>{points.first + 2, points.last}) {
      if (wall_.rowOf[q] != kNone)
        mendWall(wall_.rowOf[q]);
      else
        mendInner(q, mover_.neighbourMean(q), wall_.scale[row]);
    }
    const double bad = badness();
    if (bad <= 1 || bad > std::min(0.98 * last, kHopelessMended)) break;
    last = bad;
  }
  return trial.settle();
}

void ForcedMove::mendInner(Id point, const Vec3& ideal, double scale) const {
  double bad = mover_.badness(point);
  const auto attempt = [&](const Vec3& to) {
    if (bad > 1 && mover_.improve(point, to, bad)) bad = mover_.badness(point);
  };
  attempt(ideal);
  attempt(0.5 * (ideal + mover_.point(point)));
  for (double step : kMendSteps)
    for (int k = 0; k < 6; ++k) {
      Vec3 to = mover_.point(point);
      to[k / 2] += (k % 2 ? step : -step) * scale;
      attempt(to);
    }
}

void ForcedMove::mendAlongWall(Id row, const Attempt& attempt) const {
  const Id p = wall_.nodes[row];
  double bad = mover_.badness(p);
  if (bad <= 1) return;
  const Vec3 n = mover_.meanNormal(wall_.faces[row]);
  if (!(n.norm() > 0)) return;
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  for (double step : kMendSteps)
    for (int k = 0; k < 6 && bad > 1; ++k) {
      const double angle = k * 3.14159265358979323846 / 3;
      const Vec3 way = std::cos(angle) * u + std::sin(angle) * v;
      if (attempt(mover_.point(p) + step * wall_.scale[row] * way, bad)) bad = mover_.badness(p);
    }
}

}  // namespace pm
