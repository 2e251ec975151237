// SPDX-License-Identifier: BSD-3-Clause
// The mover of some points against that of all, sweeps in blocks, cuts and trials, and its measures against
// those that judge the mesh (thesis 4.4.1).
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "FoamQuality.h"
#include "MoverMeasures.h"
#include "NodeMover.h"
#include "TestMeshes.h"
#include "TestMoves.h"
#include "TestRandomDomains.h"

namespace {

using namespace pm;
using namespace pm::testing;

TEST(NodeMover, OfSomePointsMovesThemAsOneOfAllPointsDoes) {
  std::size_t moved = 0, still = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    PolyMesh some = layer(seed), all = some;
    const PolyMesh before = some;
    const std::vector<Id> movable = pointsNearWall(some, static_cast<int>(seed % 2));
    NodeMover few(some, {}, movable), every(all, {});
    const MoveBlocks blocks = few.blocks(movable);
    sweep(few, some, blocks);
    sweep(every, all, blocks);
    EXPECT_TRUE(some.points == all.points) << "domain " << seed;
    for (Id p : movable) {
      EXPECT_EQ(few.badness(p), every.badness(p));
      EXPECT_EQ(few.lastChange(p), every.lastChange(p));
      moved += some.points[p] != before.points[p];
    }
    still += some.points.size() - movable.size();
  }
  EXPECT_GT(moved, 500u);
  EXPECT_GT(still, 20u) << "the wall is everywhere: nothing was left out";
}

TEST(NodeMover, RefusesPointsItWasNotGiven) {
  PolyMesh mesh = layer(1);
  const std::vector<Vec3> before = mesh.points;
  const std::vector<Id> movable{0};
  NodeMover mover(mesh, {}, movable);
  const Vec3 aBit(1e-6 * mesh.finestSize, 0, 0);
  EXPECT_TRUE(mover.isMovable(0));
  EXPECT_NE(mover.tryMove(0, mesh.points[0]), Refusal::NotMovable);
  for (Id p = 1; p < static_cast<Id>(mesh.points.size()); ++p) {
    EXPECT_EQ(mover.tryMove(p, mesh.points[p] + aBit), Refusal::NotMovable);
    EXPECT_FALSE(mover.improve(p, mesh.points[p] + aBit));
    EXPECT_FALSE(mover.moveTogether({0, p}, {mesh.points[0], mesh.points[p] + aBit}));
    EXPECT_TRUE(mover.cellsOf(p).empty());
    EXPECT_EQ(mover.badness(p), 0);
  }
  EXPECT_TRUE(mesh.points == before);
}

TEST(NodeMover, RingsAreThePointsThatShareACell) {
  const PolyMesh mesh = layer(2);
  const Csr<Id> points = cellPoints(mesh);
  std::set<Id> expected;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.base[p] != kNone) expected.insert({static_cast<Id>(p), mesh.base[p]});
  for (int rings = 0; rings < 3; ++rings) {
    const std::vector<Id> found = pointsNearWall(mesh, rings);
    EXPECT_EQ(std::set<Id>(found.begin(), found.end()), expected);
    EXPECT_EQ(found.size(), expected.size()) << "a point twice";
    std::set<Id> next = expected;
    for (Id c = 0; c < mesh.cellCount; ++c)
      if (std::any_of(points[c].begin(), points[c].end(), [&](Id p) { return expected.count(p) > 0; }))
        next.insert(points[c].begin(), points[c].end());
    expected.swap(next);
  }
}

TEST(NodeMover, BlocksOfAGroupTouchNothingInCommon) {
  PolyMesh mesh = layer(3);
  const NodeMover mover(mesh, {});
  const MoveBlocks blocks = mover.blocks(allPoints(mesh));
  std::vector<Id> seen(blocks.points.values);
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(seen, allPoints(mesh)) << "not every point once";
  const Csr<Id> faces = cellFaces(mesh);
  std::size_t listed = 0;
  for (const auto& group : blocks.groups) {
    listed += group.size();
    std::vector<Id> writer(mesh.cellCount, kNone);
    const auto forEachCell = [&](Id block, const auto& body) {
      for (Id p : blocks.points[block])
        for (Id point : {p, mesh.base[p]})
          if (point != kNone)
            for (Id c : mover.cellsOf(point)) body(c);
    };
    for (Id block : group) forEachCell(block, [&](Id c) { writer[c] = block; });
    for (Id block : group)
      forEachCell(block, [&](Id c) {
        EXPECT_EQ(writer[c], block);
        for (Id f : faces[c]) {
          const bool internal = f < mesh.internalFaces();
          for (Id other : {mesh.owner[f], internal ? mesh.neighbour[f] : c})
            EXPECT_TRUE(writer[other] == kNone || writer[other] == block);
        }
      });
  }
  EXPECT_EQ(listed, static_cast<std::size_t>(blocks.points.rows()));
}

TEST(NodeMover, BlocksGiveTheSameBitsOnAnyNumberOfThreads) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::vector<std::vector<Vec3>> results;
    for (int threads : {1, 2, 4}) {
      PolyMesh mesh = layer(seed);
      withThreads(threads, [&] {
        NodeMover mover(mesh, {});
        sweep(mover, mesh, mover.blocks(allPoints(mesh)));
      });
      EXPECT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
      results.push_back(mesh.points);
    }
    EXPECT_TRUE(results[0] == results[1]) << "domain " << seed;
    EXPECT_TRUE(results[0] == results[2]) << "domain " << seed;
  }
}

TEST(NodeMover, SkipsInBlocksOnlyWhatWouldFailAgain) {
  PolyMesh mesh = layer(4);
  NodeMover mover(mesh, {});
  const MoveBlocks blocks = mover.blocks(allPoints(mesh));
  std::vector<Vec3> targets = mesh.points;
  for (Vec3& t : targets) t += mesh.finestSize * Vec3(0.4, 0.3, -0.2);
  std::vector<Id> tried(mesh.points.size(), 0);
  int skipped = 0, moved = 0;
  withThreads(1, [&] {
    for (int round = 0; round < 12; ++round)
      mover.forEach(blocks, [&](Id p) {
        const bool isWorth = mover.worthTrying(p, tried[p]);
        const Vec3 before = mesh.points[p];
        mover.drift(p, targets[p], 6);
        const bool stayed = mesh.points[p] == before;
        EXPECT_TRUE(isWorth || stayed) << "point " << p << " was not worth trying, but moved";
        skipped += !isWorth;
        moved += !stayed;
      });
  });
  EXPECT_GT(moved, 100);
  EXPECT_GT(skipped, 100);
}

/// Forces a point somewhere and mends around it as well as a few random steps can.
void tryForced(NodeMover& mover, const PolyMesh& mesh, Id p, unsigned round) {
  std::mt19937_64 g(31 * static_cast<unsigned>(p) + round);
  const double h = mesh.finestSize;
  const auto step = [&](double far) { return Vec3(far * h * randomPoint(g, -1, 1)); };
  const Id base = mesh.base[p];
  NodeMover::Trial trial(mover);
  if (base == kNone)
    trial.force({p}, {mesh.points[p] + step(0.4)});
  else
    trial.force({p, base}, {mesh.points[p] + step(0.4), mesh.points[base] + step(0.2)});
  for (int k = 0; k < 6; ++k) {
    if (base != kNone) mover.improve(base, mesh.points[base] + step(0.2));
    mover.improve(p, mesh.points[p] + step(0.1));
  }
  trial.settle();
}

std::vector<double> badnessOfAll(const NodeMover& mover, const PolyMesh& mesh) {
  std::vector<double> all;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) all.push_back(mover.badness(static_cast<Id>(p)));
  return all;
}

TEST(NodeMover, ATrialThatIsNotSettledLeavesNoTrace) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    PolyMesh mesh = layer(seed);
    NodeMover mover(mesh, {}), fresh(mesh, {});
    const std::vector<Vec3> before = mesh.points;
    std::mt19937_64 g(seed);
    for (int k = 0; k < 30; ++k) {
      const Id p = static_cast<Id>(g() % mesh.points.size());
      {
        NodeMover::Trial trial(mover);
        trial.force({p}, {mesh.points[p] + mesh.finestSize * randomPoint(g, -1, 1)});
        const auto shift = [&] { return Vec3(0.2 * mesh.finestSize * randomPoint(g, -1, 1)); };
        for (Id c : mover.cellsOf(p))
          for (Id q : mover.pointsOf(c)) mover.improve(q, mesh.points[q] + shift());
        mover.drift(p, before[p]);
        trial.force({p}, {before[p] + 20 * mesh.finestSize * Vec3::Ones()});
        if (mesh.fixed[p] != 7) {
          EXPECT_TRUE(mesh.points != before);
        }
        if (k % 2 == 0 && mesh.fixed[p] != 7) {
          EXPECT_FALSE(trial.settle()) << "point " << p;
        }
      }
      ASSERT_TRUE(mesh.points == before) << "domain " << seed << ", point " << p;
    }
    EXPECT_EQ(badnessOfAll(mover, mesh), badnessOfAll(fresh, mesh));
    for (Id f = 0; f < mesh.faceCount(); ++f) {
      EXPECT_EQ(mover.faceCentre(f), fresh.faceCentre(f));
      EXPECT_EQ(mover.faceNormal(f), fresh.faceNormal(f));
    }
    for (Id c = 0; c < mesh.cellCount; ++c) EXPECT_EQ(mover.cellCentre(c), fresh.cellCentre(c));
  }
}

TEST(NodeMover, ASettledTrialLeavesAValidMeshAndCurrentMeasures) {
  std::size_t settled = 0, undone = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    PolyMesh mesh = layer(seed);
    NodeMover mover(mesh, {});
    for (Id p = 0; p < static_cast<Id>(mesh.points.size()); ++p) {
      const Vec3 before = mesh.points[p];
      tryForced(mover, mesh, p, 1);
      ++(mesh.points[p] == before ? undone : settled);
    }
    EXPECT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
    EXPECT_EQ(badnessOfAll(mover, mesh), badnessOfAll(NodeMover(mesh, {}), mesh));
  }
  EXPECT_GT(settled, 100u);
  EXPECT_GT(undone, 100u);
}

TEST(NodeMover, ATrialMayPassThroughWhatIsNotValid) {
  VoxelOptions o;
  o.size = {4, 4, 2};
  PolyMesh mesh = layeredVoxels(o);
  NodeMover mover(mesh, {});
  const Id wall = static_cast<Id>(
      std::find_if(mesh.base.begin(), mesh.base.end(), [](Id b) { return b != kNone; }) - mesh.base.begin());
  const Vec3 home = mesh.points[wall], inside = 2.5 * mesh.points[mesh.base[wall]] - 1.5 * home;
  ASSERT_NE(mover.tryMove(wall, inside), Refusal::None);
  NodeMover::Trial trial(mover);
  trial.force({wall}, {inside});
  EXPECT_EQ(mesh.points[wall], inside);
  EXPECT_GT(mover.badness(wall), 1);
  EXPECT_FALSE(trial.settle());
  EXPECT_TRUE(mover.improve(wall, home)) << "the way back is better";
  EXPECT_TRUE(trial.settle());
  EXPECT_EQ(whatIsWrong(mesh), "");
}

TEST(NodeMover, ForcedMovesOfOtherPointsDoNothing) {
  PolyMesh mesh = layer(1);
  const std::vector<Vec3> before = mesh.points;
  NodeMover mover(mesh, {}, std::vector<Id>{0});
  const Vec3 far = mesh.finestSize * Vec3(3, 2, 1);
  {
    NodeMover::Trial trial(mover);
    for (Id p = 1; p < static_cast<Id>(mesh.points.size()); ++p) {
      trial.force({p}, {mesh.points[p] + far});
      trial.force({0, p}, {mesh.points[0] + far, mesh.points[p] + far});
      ASSERT_TRUE(mesh.points == before);
    }
    EXPECT_TRUE(trial.settle()) << "nothing has happened";
  }
  EXPECT_TRUE(mesh.points == before);
}

TEST(NodeMover, TrialsGiveTheSameBitsOnAnyNumberOfThreads) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::vector<std::vector<Vec3>> results;
    for (int threads : {1, 2, 4}) {
      PolyMesh mesh = layer(seed);
      const std::vector<Vec3> before = mesh.points;
      withThreads(threads, [&] {
        NodeMover mover(mesh, {});
        const auto groups = mover.colour(allPoints(mesh));
        for (unsigned round = 0; round < 2; ++round)
          mover.forEach(groups, [&](Id p) { tryForced(mover, mesh, p, round); });
      });
      EXPECT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
      for (std::size_t p = 0; p < before.size(); ++p) moved += mesh.points[p] != before[p];
      results.push_back(mesh.points);
    }
    EXPECT_TRUE(results[0] == results[1]) << "domain " << seed;
    EXPECT_TRUE(results[0] == results[2]) << "domain " << seed;
  }
  EXPECT_GT(moved, 300u);
}

TEST(MoverMeasures, EqualThoseOfTheWholeMesh) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const PolyMesh mesh = shaken(seed);
    const MeshMeasures m = measure(mesh);
    const Csr<Id> faces = cellFaces(mesh), points = cellPoints(mesh);
    const double h = mesh.finestSize, volume = h * h * h;
    for (Id c = 0; c < mesh.cellCount; ++c) {
      std::vector<CellFace> own;
      for (Id f : faces[c])
        own.push_back(
            {mesh.faces[f], &m.faces[f].centre, &m.faces[f].normal, mesh.owner[f] == c ? 1.0 : -1.0});
      const CellMeasures now = measureCell(mesh.points, points[c], {own.data(), own.data() + own.size()});
      EXPECT_NEAR(now.volume, m.cells[c].volume, 1e-12 * volume);
      EXPECT_NEAR(now.minTet, m.cells[c].minTet, 1e-12 * volume);
      EXPECT_NEAR(now.minPyramid, m.cells[c].minPyramid, 1e-12 * volume);
      EXPECT_LT((now.centre - m.cells[c].centre).norm(), 1e-10 * h);
      EXPECT_LT((now.foamCentre - m.cells[c].foamCentre).norm(), 1e-10 * h);
    }
    const double enough = 1e-6 * volume;
    for (Id f = 0; f < mesh.faceCount(); ++f) {
      const FaceMeasures& face = m.faces[f];
      const CellMeasures& own = m.cells[mesh.owner[f]];
      const CellMeasures* next = f < mesh.internalFaces() ? &m.cells[mesh.neighbour[f]] : nullptr;
      const FaceRelation r = relate(mesh.points, mesh.faces[f], face.centre, face.normal, own, next, enough);
      EXPECT_NEAR(r.skew, m.faceSkew[f], 1e-6);
      EXPECT_NEAR(r.tet,
                  faceTetVolume(mesh.points, mesh.faces[f], face, own.foamCentre,
                                next ? &next->foamCentre : nullptr, enough),
                  1e-12 * volume);
      if (next == nullptr) continue;
      const double worse = std::max(faceAngle(face.normal, next->centre - own.centre),
                                    faceAngle(face.normal, next->foamCentre - own.foamCentre));
      EXPECT_NEAR(r.cosAngle, std::cos(worse * 3.14159265358979323846 / 180), 1e-12);
      EXPECT_NEAR(r.weight, faceWeight(face, own.foamCentre, next->foamCentre), 1e-12);
      EXPECT_NEAR(r.volumeRatio, volumeRatio(own.volume, next->volume), 1e-12);
    }
  }
}

}  // namespace
