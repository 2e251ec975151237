// SPDX-License-Identifier: BSD-3-Clause
// Courses of prism edges, pinched edges, and the direction that sees all wall faces.
#include "LayerPoints.h"

#include <gtest/gtest.h>

#include <cmath>

#include "BoundaryRefine.h"
#include "LayerSplit.h"
#include "TestMeshes.h"
#include "WallSight.h"

namespace {

using namespace pm;
using namespace pm::testing;

TEST(WallSight, FlatEdgeAndCorner) {
  const PolyMesh cube = layeredVoxels(cubeInBox());
  const WallSight sight(cube);
  int corners = 0;
  for (Id p = 0; p < static_cast<Id>(cube.points.size()); ++p) {
    if (cube.base[p] == kNone) continue;
    ++corners;
    EXPECT_NEAR(sight.bestCosine(p), std::sqrt(1.0 / 3), 1e-3);
    EXPECT_NEAR(sight.best(p).norm(), 1, 1e-12);
    EXPECT_NEAR(sight.cosine(p, 5 * sight.best(p)), sight.bestCosine(p), 1e-12);
  }
  EXPECT_EQ(corners, 8);
}

TEST(WallSight, KeepsToDomainSides) {
  VoxelOptions o;
  o.size = {3, 3, 2};
  o.wallSide = {false, false, false, false, false, true};
  o.deform = [](const Vec3& p) { return Vec3(p.x(), p.y(), p.z() + 0.1 * p.x()); };
  const PolyMesh mesh = layeredVoxels(o);
  const WallSight sight(mesh);
  int onSide = 0;
  for (Id p = 0; p < static_cast<Id>(mesh.points.size()); ++p) {
    if (mesh.base[p] == kNone) continue;
    for (int a = 0; a < 3; ++a)
      if (mesh.fixed[p] >> a & 1) {
        EXPECT_EQ(sight.best(p)[a], 0);
        ++onSide;
      }
  }
  EXPECT_EQ(onSide, 16);
}

void wantThree(LayerColumns& columns) {
  std::vector<Id> all;
  for (Id c = 0; c < columns.count(); ++c) {
    columns.want(c, 3);
    all.push_back(c);
  }
  columns.updateEdges(all);
}

/// All edges of a cube's layers at one course, split.
PolyMesh atCourse(const PolyMesh& mesh, int course, Id onlyEvery) {
  LayerColumns columns(mesh);
  const WallSight sight(mesh);
  std::vector<EdgeHeights> heights(mesh.points.size(), {0.05, 1.2, 0});
  wantThree(columns);
  LayerPoints points(mesh, columns, sight, heights);
  Id n = 0;
  for (Id b = 0; b < static_cast<Id>(mesh.points.size()); ++b)
    if (columns.wallPoint(b) >= 0 && n++ % onlyEvery == 0) {
      EXPECT_TRUE(points.setCourse(b, course));
    }
  return splitLayers(mesh, columns, points.all());
}

TEST(LayerPoints, EveryCourseKeepsTopologyAndVolume) {
  VoxelOptions o;
  o.size = {5, 4, 2};
  o.wallSide = {false, false, false, false, false, true};
  for (const PolyMesh& mesh : {layeredVoxels(cubeInBox()), layeredVoxels(o)}) {
    const double volume = summarise(mesh, measure(mesh), {}).totalVolume;
    for (int course = 0; course < LayerPoints::kCourses; ++course)
      for (Id every : {1, 2, 3}) {
        const PolyMesh split = atCourse(mesh, course, every);
        // All edges pinched leaves caps on the wall itself: topology alone means nothing there.
        if (course == LayerPoints::kCourses - 1 && every == 1) continue;
        EXPECT_EQ(checkTopology(split), "") << "course " << course << " every " << every;
        EXPECT_NEAR(summarise(split, measure(split), {}).totalVolume / volume, 1, 1e-12);
      }
  }
}

TEST(LayerPoints, SharesOfAnEdgeFollowItsLength) {
  PolyMesh mesh = layeredVoxels(cubeInBox());
  LayerColumns columns(mesh);
  const WallSight sight(mesh);
  std::vector<Id> all;
  for (Id c = 0; c < columns.count(); ++c) {
    columns.want(c, 2);
    all.push_back(c);
  }
  columns.updateEdges(all);
  for (const bool shares : {false, true}) {
    Id lower = 0;
    while (columns.wallPoint(lower) < 0) ++lower;
    const Id wall = columns.wallPoint(lower);
    const Vec3 edge = mesh.points[lower] - mesh.points[wall];
    const std::vector<EdgeHeights> heights(mesh.points.size(), {0.1, 1.2, shares ? edge.norm() : 0});
    LayerPoints points(mesh, columns, sight, heights);
    mesh.points[lower] = mesh.points[wall] + 2 * edge;
    points.follow(lower);
    const Vec3 first = points.all()[columns.firstPoint(lower)] - mesh.points[wall];
    EXPECT_NEAR(first.norm(), shares ? 0.2 : 0.1, 1e-12);
    mesh.points[lower] = mesh.points[wall] + edge;
  }
}

TEST(LayerPoints, PinchedEdgesHaveNoPoints) {
  const PolyMesh mesh = layeredVoxels(cubeInBox());
  const Id straight = static_cast<Id>(atCourse(mesh, 0, 1).points.size());
  EXPECT_EQ(straight, static_cast<Id>(mesh.points.size()) + 8 * 2);
  EXPECT_EQ(static_cast<Id>(atCourse(mesh, LayerPoints::kCourses - 1, 2).points.size()), straight - 4 * 2);
}

TEST(LayerPoints, LeansEndAtTheWallAndKeepToDomainSides) {
  VoxelOptions o;
  o.size = {3, 3, 2};
  o.wallSide = {false, false, false, false, false, true};
  const PolyMesh mesh = layeredVoxels(o);
  LayerColumns columns(mesh);
  const WallSight sight(mesh);
  const std::vector<EdgeHeights> heights(mesh.points.size(), {0.1, 1, 0});
  wantThree(columns);
  LayerPoints points(mesh, columns, sight, heights);
  int leaning = 0;
  for (Id b = 0; b < columns.pointCount(); ++b) {
    if (columns.wallPoint(b) < 0) continue;
    points.setLean(b, Vec3(0.3, 0.3, 0));
    const Vec3& wall = mesh.points[columns.wallPoint(b)];
    const bool onX = wall.x() == 0 || wall.x() == 3, onY = wall.y() == 0 || wall.y() == 3;
    for (Id level = 1; level < 3; ++level) {
      const Vec3 at = points.all()[columns.firstPoint(b) + level - 1] - wall;
      const double part = 0.3 * level, aside = 0.3 * part * (1 - part) / 3;  // the edge is 1/3 long
      EXPECT_NEAR(at.x(), onX ? 0 : aside, 1e-12);
      EXPECT_NEAR(at.y(), onY ? 0 : aside, 1e-12);
      EXPECT_NEAR(at.z(), -part / 3, 1e-12);
      leaning += !onX && !onY;
    }
    points.setLean(b, Vec3::Zero());
    EXPECT_NEAR((points.all()[columns.firstPoint(b)] - wall).norm(), 0.1, 1e-12);
  }
  EXPECT_EQ(leaning, 4 * 2);
}

}  // namespace
