// SPDX-License-Identifier: BSD-3-Clause
#include "WallSight.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "MeshQuality.h"

namespace pm {
namespace {

constexpr int kSteps = 30;
constexpr double kFirstStep = 0.5, kShrink = 0.85;  // together turn a direction by more than half a circle

}  // namespace

WallSight::WallSight(const PolyMesh& mesh) {
  const Id internal = mesh.internalFaces();
  std::vector<Id>& offsets = normals_.offsets;
  offsets.assign(mesh.points.size() + 1, 0);
  const auto forEachWallFace = [&](const auto& body) {
    for (Id f = internal; f < mesh.faceCount(); ++f)
      if (mesh.isWallPatch(mesh.patch[f - internal])) body(f);
  };
  forEachWallFace([&](Id f) {
    for (Id p : mesh.faces[f]) ++offsets[p + 1];
  });
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  normals_.values.resize(offsets.back());
  std::vector<Id> next(offsets.begin(), offsets.end() - 1);
  forEachWallFace([&](Id f) {
    const Vec3 inward = -measureFace(mesh.points, mesh.faces[f], true).normal.normalized();
    for (Id p : mesh.faces[f]) normals_.values[next[p]++] = inward;
  });
  best_.assign(mesh.points.size(), Vec3::Zero());
  bestCosine_.assign(mesh.points.size(), 1);
  tbb::parallel_for(tbb::blocked_range<Id>(0, normals_.rows(), 1024), [&](const auto& range) {
    for (Id p = range.begin(); p != range.end(); ++p)
      if (!normals_[p].empty()) findBest(mesh, p);
  });
}

double WallSight::cosine(Id wallPoint, const Vec3& direction) const {
  const Vec3 unit = direction.normalized();
  double least = 1;
  for (const Vec3& n : normals_[wallPoint]) least = std::min(least, n.dot(unit));
  return least;
}

/// Turns the mean normal towards the face seen worst, less with each step.
void WallSight::findBest(const PolyMesh& mesh, Id point) {
  const Span<Vec3> normals = normals_[point];
  const auto keptToSides = [&](Vec3 d) {
    for (int a = 0; a < 3; ++a)
      if (mesh.fixed[point] >> a & 1) d[a] = 0;
    return d.norm() > 0 ? Vec3(d.normalized()) : Vec3(normals[0]);
  };
  Vec3 direction = Vec3::Zero();
  for (const Vec3& n : normals) direction += n;
  bestCosine_[point] = -2;
  double step = kFirstStep;
  for (int i = 0; i < kSteps; ++i, step *= kShrink) {
    direction = keptToSides(direction);
    const Vec3* worst = normals.begin();
    for (const Vec3& n : normals)
      if (n.dot(direction) < worst->dot(direction)) worst = &n;
    const double least = worst->dot(direction);
    if (least > bestCosine_[point]) {
      bestCosine_[point] = least;
      best_[point] = direction;
    }
    direction += step * *worst;
  }
}

}  // namespace pm
