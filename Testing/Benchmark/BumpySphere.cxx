// SPDX-License-Identifier: BSD-3-Clause
#include "BumpySphere.h"

#include <cmath>
#include <map>

namespace pm::benchmarking {
namespace {

constexpr double kPi = 3.14159265358979323846;

Vec3 onSphere(Vec3 p) {
  for (int a = 0; a < 3; ++a) p[a] = std::tan(p[a] * kPi / 4);  // evens out the squares
  p.normalize();
  return p * (1 + 0.05 * std::sin(9 * p[0]) * std::sin(8 * p[1]) * std::sin(7 * p[2]));
}

std::unique_ptr<SurfaceModel> makeSphere(Id triangles) {
  const Id n = std::max(1, static_cast<Id>(std::lround(std::sqrt(triangles / 12.0))));
  std::vector<Vec3> points;
  std::vector<SurfaceModel::Triangle> rows;
  for (int side = 0; side < 6; ++side) {
    const Id first = static_cast<Id>(points.size());
    const int axis = side / 2;
    const double sign = side % 2 ? 1 : -1;
    for (Id j = 0; j <= n; ++j)
      for (Id i = 0; i <= n; ++i) {
        Vec3 p;
        p[axis] = sign;
        p[(axis + 1) % 3] = sign * (2.0 * i / n - 1);
        p[(axis + 2) % 3] = 2.0 * j / n - 1;
        points.push_back(onSphere(p));
      }
    for (Id j = 0; j < n; ++j)
      for (Id i = 0; i < n; ++i) {
        const Id a = first + i + (n + 1) * j, b = a + 1, c = a + n + 1, d = c + 1;
        rows.push_back({a, b, d});
        rows.push_back({a, d, c});
      }
  }
  return std::make_unique<SurfaceModel>(points, rows, std::vector<Id>(rows.size(), 0),
                                        std::vector<std::string>{"sphere"});
}

}  // namespace

const SurfaceModel& bumpySphere(Id triangles) {
  static std::map<Id, std::unique_ptr<SurfaceModel>> made;
  std::unique_ptr<SurfaceModel>& sphere = made[triangles];
  if (!sphere) sphere = makeSphere(triangles);
  return *sphere;
}

double triangleEdge(Id triangles) { return std::sqrt(4 * kPi / triangles * 4 / std::sqrt(3.0)); }

}  // namespace pm::benchmarking
