// SPDX-License-Identifier: BSD-3-Clause
#include "LayerPoints.h"

#include <cmath>

namespace pm {
namespace {

constexpr double kLeastSight = 0.1;  // of a wall point whose edge is pinched from the start

/// How far an edge starts in the direction of best sight (1) or straight (0), and its layers' heights over
/// those wanted.
struct Course {
  double bend, scale;
};
constexpr Course kCourseList[LayerPoints::kCourses] = {{0, 1},   {1, 1},    {1, 0.8},  {0, 0.8},  {1, 0.5},
                                                       {0, 0.5}, {1, 0.25}, {0, 0.25}, {1, 0.12}, {0, 0}};

}  // namespace

double EdgeHeights::sum(Id layers) const {
  double total = 0, height = first;
  for (Id i = 0; i < layers; ++i, height *= expansion) total += height;
  return total;
}

LayerPoints::LayerPoints(const PolyMesh& mesh, LayerColumns& columns, const WallSight& sight,
                         const std::vector<EdgeHeights>& heights)
    : mesh_(mesh), columns_(columns), sight_(sight), heights_(heights), all_(mesh.points) {
  const Id old = static_cast<Id>(mesh.points.size());
  all_.resize(columns.numberPoints(old));
  course_.assign(old, 0);
  lean_.assign(old, Vec3::Zero());
  std::vector<Id> edges(old, 0);
  for (Id b = 0; b < old; ++b)
    if (columns.wallPoint(b) >= 0) ++edges[columns.wallPoint(b)];
  single_.assign(old, 0);
  for (Id p = 0; p < old; ++p) single_[p] = edges[p] == 1;
  for (Id b = 0; b < old; ++b) {
    if (columns.edgeLayers(b) == 1) continue;
    follow(b);
    if (sight.bestCosine(columns.wallPoint(b)) < kLeastSight) setCourse(b, kPinched);
  }
}

bool LayerPoints::setCourse(Id lower, int course) {
  if (!single_[columns_.wallPoint(lower)]) return course == course_[lower];
  if ((course == kPinched) != columns_.isPinched(lower)) columns_.pinch(lower, course == kPinched);
  course_[lower] = static_cast<std::uint8_t>(course);
  follow(lower);
  return true;
}

void LayerPoints::setLean(Id lower, const Vec3& lean) {
  lean_[lower] = lean;
  const int fixed = mesh_.fixed[lower] & mesh_.fixed[columns_.wallPoint(lower)];
  for (int a = 0; a < 3; ++a)
    if (fixed >> a & 1) lean_[lower][a] = 0;
  follow(lower);
}

void LayerPoints::follow(Id lower) {
  all_[lower] = mesh_.points[lower];
  const Id inner = columns_.edgeLayers(lower) - 1;
  if (inner == 0) return;
  const Id wall = columns_.wallPoint(lower);
  const Vec3 edge = mesh_.points[lower] - mesh_.points[wall];
  const double length = edge.norm();
  const Course course = kCourseList[course_[lower]];
  const double whole = heights_[lower].share > 0 ? heights_[lower].share : length;
  const Vec3 aside = course.bend * (length * sight_.best(wall) - edge) + length * lean_[lower];
  for (Id i = 0; i < inner; ++i) {
    const double part = course.scale * heights_[lower].sum(i + 1) / whole;
    all_[columns_.firstPoint(lower) + i] = mesh_.points[wall] + part * (edge + (1 - part) * aside);
  }
}

}  // namespace pm
