// SPDX-License-Identifier: BSD-3-Clause
// NodeMover's moves of many points at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "NodeMover.h"
#include "TestMoves.h"
#include "TestRandomDomains.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr unsigned kMeshes = 20;

/// For each point somewhere around it, at most so many of the finest cells away along each axis.
std::vector<Vec3> placesAround(const PolyMesh& mesh, double reach, unsigned seed) {
  std::mt19937_64 g(seed);
  std::vector<Vec3> places;
  for (const Vec3& p : mesh.points) places.push_back(p + reach * mesh.finestSize * randomPoint(g, -1, 1));
  return places;
}

/// Where a point is that has gone a part of its way; its fixed coordinates stay.
Vec3 placeOf(const PolyMesh& before, Id p, const Vec3& target, double part) {
  const Vec3& from = before.points[p];
  Vec3 to = part == 1 ? target : Vec3(from + 0.5 * (target - from));
  for (int a = 0; a < 3; ++a)
    if (part == 0 || (before.fixed[p] >> a & 1)) to[a] = from[a];
  return to;
}

TEST(MoveAll, LeavesValidMeshesAndTrueCaches) {
  std::size_t kept = 0, half = 0, back = 0;
  for (unsigned seed = 0; seed < kMeshes; ++seed) {
    PolyMesh mesh = seed % 2 ? shaken(seed) : layer(seed);
    const PolyMesh before = mesh;
    const std::vector<Vec3> targets = placesAround(mesh, 0.02 + 0.02 * (seed % 8), seed);
    NodeMover mover(mesh, {});
    const std::vector<float> part = mover.moveAll(allPoints(mesh), targets);
    ASSERT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
    for (Id p : allPoints(mesh)) {
      EXPECT_EQ(mesh.points[p], placeOf(before, p, targets[p], part[p])) << "point " << p;
      kept += part[p] == 1;
      half += part[p] == 0.5;
      back += part[p] == 0;
    }
    const NodeMover fresh(mesh, {});
    for (Id f = 0; f < mesh.faceCount(); ++f) ASSERT_EQ(mover.faceNormal(f), fresh.faceNormal(f));
    for (Id c = 0; c < mesh.cellCount; ++c) ASSERT_EQ(mover.cellCentre(c), fresh.cellCentre(c));
    for (Id p : allPoints(mesh)) ASSERT_EQ(mover.badness(p), fresh.badness(p));
  }
  EXPECT_GT(kept, 500u);
  EXPECT_GT(half, 50u);
  EXPECT_GT(back, 50u);
}

TEST(MoveAll, WhatBreaksNoLimitGoesAllTheWay) {
  for (unsigned seed = 0; seed < kMeshes; ++seed) {
    PolyMesh mesh = layer(seed);
    const std::vector<Vec3> targets = placesAround(mesh, 1e-7, seed);
    const std::vector<float> part = NodeMover(mesh, {}).moveAll(allPoints(mesh), targets);
    EXPECT_EQ(std::count(part.begin(), part.end(), 1.0f), static_cast<std::ptrdiff_t>(part.size()));
  }
}

TEST(MoveAll, OnlyPointsThatMayMoveDo) {
  PolyMesh mesh = shaken(3);
  const PolyMesh before = mesh;
  const std::vector<Id> movable = pointsNearWall(mesh, 0);
  NodeMover mover(mesh, {}, movable);
  const std::vector<Vec3> targets = placesAround(mesh, 0.03, 1);
  const std::vector<float> part = mover.moveAll(allPoints(mesh), targets);
  std::size_t moved = 0;
  for (Id p : allPoints(mesh)) {
    if (!mover.isMovable(p)) {
      EXPECT_EQ(part[p], 0);
      EXPECT_EQ(mesh.points[p], before.points[p]);
    }
    moved += mesh.points[p] != before.points[p];
  }
  EXPECT_GT(moved, movable.size() / 4);
  EXPECT_EQ(whatIsWrong(mesh), "");
}

TEST(MoveAll, APointNamedTwiceGoesWhereItWasToGoFirst) {
  PolyMesh mesh = layer(2);
  std::vector<Id> free;
  for (Id p : allPoints(mesh))
    if (mesh.fixed[p] == 0) free.push_back(p);
  ASSERT_GE(free.size(), 2u);
  const Id p = free[0], q = free[1];
  const Vec3 step = Vec3::Constant(1e-6 * mesh.finestSize), to = mesh.points[p] + step;
  NodeMover mover(mesh, {});
  const std::vector<float> part = mover.moveAll({p, q, p}, {to, mesh.points[q] + step, to + step});
  EXPECT_EQ(part, (std::vector<float>{1, 1, 0}));
  EXPECT_EQ(mesh.points[p], to);
  EXPECT_EQ(whatIsWrong(mesh), "");
}

/// What is outside a limit may stay so, but no worse; what is within stays within.
TEST(MoveAll, MakesNothingWorseThatIsOutsideALimit) {
  QualityLimits strict;
  strict.maxWarpage = 4;
  std::size_t outside = 0, moved = 0;
  for (unsigned seed = 0; seed < kMeshes; ++seed) {
    PolyMesh mesh = shaken(seed);
    const MeshMeasures before = measure(mesh);
    const std::vector<Vec3> start = mesh.points, targets = placesAround(mesh, 0.05, seed);
    NodeMover(mesh, strict).moveAll(allPoints(mesh), targets);
    const MeshMeasures after = measure(mesh);
    for (Id f = 0; f < mesh.faceCount(); ++f) {
      const double was = before.faces[f].warpage();
      EXPECT_LE(after.faces[f].warpage(), std::max(strict.maxWarpage, was) + 1e-4) << "face " << f;
      outside += was > strict.maxWarpage;
    }
    for (Id p : allPoints(mesh)) moved += mesh.points[p] != start[p];
  }
  EXPECT_GT(outside, 100u);
  EXPECT_GT(moved, 100u);
}

TEST(MoveAll, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (unsigned seed = 0; seed < kMeshes; ++seed) {
    const PolyMesh mesh = shaken(seed);
    const auto moved = [&](int threads) {
      PolyMesh copy = mesh;
      withThreads(threads, [&] {
        NodeMover mover(copy, {});
        for (unsigned k = 0; k < 3; ++k) mover.moveAll(allPoints(copy), placesAround(copy, 0.1, k));
      });
      return copy.points;
    };
    const std::vector<Vec3> one = moved(1);
    EXPECT_TRUE(one == moved(2)) << "domain " << seed;
    EXPECT_TRUE(one == moved(4)) << "domain " << seed;
    EXPECT_FALSE(one == mesh.points);
  }
}

TEST(MoveAll, IsSeenByThoseWhoTryAgainOnlyAfterAChange) {
  PolyMesh mesh = layer(5);
  NodeMover mover(mesh, {});
  std::vector<Id> tried(mesh.points.size(), 0);
  const auto attempts = [&] {
    std::size_t count = 0;
    for (Id p : allPoints(mesh)) mover.forEach({{p}}, [&](Id q) { count += mover.worthTrying(q, tried[q]); });
    return count;
  };
  EXPECT_EQ(attempts(), mesh.points.size());
  EXPECT_EQ(attempts(), 0u);
  const Id p = static_cast<Id>(mesh.points.size()) / 2;
  const std::vector<float> part =
      mover.moveAll({p}, {mesh.points[p] + Vec3::Constant(1e-6 * mesh.finestSize)});
  EXPECT_EQ(part[0], 1);
  const std::size_t again = attempts();
  EXPECT_GT(again, 7u);
  EXPECT_LT(again, mesh.points.size());
}

TEST(MoveAll, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  PolyMesh mesh = layer(1);
  const std::vector<Vec3> targets = placesAround(mesh, 0.1, 1);
  NodeMover mover(mesh, {}, &stop);
  EXPECT_THROW(mover.moveAll(allPoints(mesh), targets), AbortError);
}

}  // namespace
