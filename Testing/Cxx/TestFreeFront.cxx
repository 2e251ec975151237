// SPDX-License-Identifier: BSD-3-Clause
// The front as a surface by itself: on the geometry, even, and nothing of the mesh moved.
#include "FreeFront.h"

#include <gtest/gtest.h>

#include <cmath>

#include "TestLayered.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// Around a geometry that stands through the floor of the domain.
PolyMesh layeredOnFloor(const SurfaceModel& model, double size) {
  OctreeDecomposeOptions o;
  o.featureSize = size;
  o.useDomain = true;
  o.domain.add(Vec3(-3, -3, 0.5));
  o.domain.add(Vec3(3, 3, 4));
  return layered(model, o, Region::Outside);
}

std::vector<Vec3> goals(const PolyMesh& mesh, const WallSurface& wall, const SurfaceModel& model) {
  Monitor monitor;
  return freeFront(
      mesh, wall, [&](Id, const Vec3& from) { return Vec3(model.closest(from).point - from); }, monitor);
}

TEST(FreeFront, LiesOnTheGeometryWithoutFolds) {
  const auto model = cylinder(64).model();
  const PolyMesh mesh = layered(*model, 0.1);
  const std::vector<Vec3> before = mesh.points;
  const WallSurface wall = wallSurface(mesh);
  const std::vector<Vec3> goal = goals(mesh, wall, *model);
  ASSERT_EQ(goal.size(), wall.nodes.size());
  EXPECT_EQ(mesh.points, before);
  for (const Vec3& place : goal) EXPECT_LT(std::sqrt(model->closest(place).distance2), 1e-9);
  // Each face looks out of the cylinder, as its stair did not.
  PolyMesh moved = mesh;
  for (Id row = 0; row < wall.size(); ++row) moved.points[wall.nodes[row]] = goal[row];
  int inwards = 0, faces = 0;
  for (Id f = moved.internalFaces(); f < moved.faceCount(); ++f) {
    const FaceMeasures m = measureFace(moved.points, moved.faces[f], true);
    const Vec3 radial(m.centre.x(), m.centre.y(), 0);
    ++faces;
    inwards += std::abs(m.normal.z()) < 0.5 * m.normal.norm() && m.normal.dot(radial) <= 0;
  }
  EXPECT_GT(faces, 1000);
  EXPECT_EQ(inwards, 0);
}

TEST(FreeFront, KeepsFixedCoordinates) {
  const auto model = cylinder(48).model();
  const PolyMesh mesh = layeredOnFloor(*model, 0.15);
  const WallSurface wall = wallSurface(mesh);
  const std::vector<Vec3> goal = goals(mesh, wall, *model);
  int fixed = 0;
  for (Id row = 0; row < wall.size(); ++row)
    for (int a = 0; a < 3; ++a) {
      if (!(mesh.fixed[wall.nodes[row]] >> a & 1)) continue;
      ++fixed;
      EXPECT_EQ(goal[row][a], mesh.points[wall.nodes[row]][a]);
    }
  EXPECT_GT(fixed, 20);
}

TEST(FreeFront, StopsWhenAsked) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  const auto model = cylinder(32).model();
  const PolyMesh mesh = layered(*model, 0.2);
  const auto stay = [](Id, const Vec3&) { return Vec3(Vec3::Zero()); };
  EXPECT_THROW(freeFront(mesh, wallSurface(mesh), stay, stop), AbortError);
}

}  // namespace
