// SPDX-License-Identifier: BSD-3-Clause
// A node forced to its place: either the mesh is valid with it there, or nothing has moved.
#include "ForcedMove.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "TestMoves.h"
#include "TestRandomDomains.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

struct Forced {
  int kept = 0, putBack = 0, notByAMove = 0;
};

/// Forces every wall node of the mesh somewhere near; says how often it went.
Forced forceAll(PolyMesh& mesh, unsigned seed) {
  const WallSurface wall = wallSurface(mesh);
  NodeMover mover(mesh, {});
  const ForcedMove forced(mover, wall);
  std::mt19937_64 g(seed);
  Forced count;
  for (Id row = 0; row < wall.size(); ++row) {
    const Id p = wall.nodes[row];
    const std::vector<Id> points = forced.points(row);
    const std::vector<Vec3> before = mesh.points;
    const Vec3 to = mesh.points[p] + 0.7 * wall.scale[row] * randomPoint(g, -1, 1);
    const bool alone = mover.move(p, to);
    if (alone) mover.move(p, before[p]);
    const bool kept = forced.force(row, {points.data(), points.data() + points.size()}, to, [&](Id n) {
      forced.mendAlongWall(
          n, [&](const Vec3& at, double badness) { return mover.improve(wall.nodes[n], at, badness); });
    });
    count.notByAMove += kept && !alone;
    ++(kept ? count.kept : count.putBack);
    for (std::size_t q = 0; q < mesh.points.size(); ++q) {
      const bool may = kept && std::count(points.begin(), points.end(), static_cast<Id>(q)) > 0;
      EXPECT_TRUE(may || mesh.points[q] == before[q]) << "point " << q << " when " << p << " is forced";
    }
  }
  return count;
}

TEST(ForcedMove, EndsValidOrPutsEverythingBack) {
  Forced all;
  for (unsigned seed = 0; seed < 10; ++seed) {
    PolyMesh mesh = layer(seed);
    const Forced one = forceAll(mesh, seed);
    EXPECT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
    all.kept += one.kept;
    all.putBack += one.putBack;
    all.notByAMove += one.notByAMove;
  }
  EXPECT_GT(all.kept, 100);
  EXPECT_GT(all.putBack, 100);
  EXPECT_GT(all.notByAMove, 20) << "the neighbours' giving way is what makes the difference";
}

TEST(ForcedMove, MendsAPointOffTheWall) {
  int broken = 0, mended = 0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const PolyMesh whole = layer(seed);
    const WallSurface wall = wallSurface(whole);
    std::mt19937_64 g(seed);
    for (Id p = 0; p < static_cast<Id>(whole.points.size()); ++p) {
      PolyMesh mesh = whole;
      if (wall.rowOf[p] != kNone || mesh.fixed[p] != 0) continue;
      mesh.points[p] += 0.5 * mesh.finestSize * randomPoint(g, -1, 1);
      NodeMover mover(mesh, {});
      const double before = mover.badness(p);
      if (before <= 1) continue;
      ++broken;
      ForcedMove(mover, wall).mendInner(p, mover.neighbourMean(p), mesh.finestSize);
      EXPECT_LE(mover.badness(p), before);
      mended += mover.badness(p) <= 1;
    }
  }
  EXPECT_GT(broken, 50);
  EXPECT_GT(mended, 0.8 * broken);
}

TEST(ForcedMove, TakesTheColumnFirstThenItsNeighbours) {
  PolyMesh mesh = layer(2);
  const WallSurface wall = wallSurface(mesh);
  NodeMover mover(mesh, {});
  const ForcedMove forced(mover, wall);
  for (Id row = 0; row < wall.size(); ++row) {
    std::vector<Id> points = forced.points(row);
    EXPECT_EQ(points[0], wall.nodes[row]);
    EXPECT_EQ(points[1], mesh.base[wall.nodes[row]]);
    for (std::size_t k = 0; k < wall.neighbours[row].size(); ++k)
      EXPECT_EQ(points[2 + k], wall.nodes[wall.neighbours[row][k]]);
    std::sort(points.begin(), points.end());
    EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end()) << "each once";
  }
}

}  // namespace
