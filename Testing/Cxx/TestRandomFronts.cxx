// SPDX-License-Identifier: BSD-3-Clause
// Property tests: whatever is painted, the repaired front is permitted, the layer on it is valid (thesis
// 3.5.1, 4.2.3), and stays so in a storm of moves (4.4.1).
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>

#include "DummyLayer.h"
#include "FrontPredicates.h"
#include "NodeMover.h"
#include "TestMoves.h"
#include "TestRandomDomains.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr unsigned kDomains = 3000;
constexpr unsigned kStormyMeshes = 40, kStorms = 3, kMovesInAStorm = 400, kPressedPoints = 30;

double stretchOf(unsigned seed) { return seed % 3 == 0 ? 2 : 1; }

PolyMesh layerOn(unsigned seed) {
  const RandomDomain domain = randomDomain(seed, stretchOf(seed));
  Monitor monitor;
  PolyMesh front = repairedFront(domain, seed % 2).mesh;
  return front.cellCount > 0 ? dummyLayer(std::move(front), {}, monitor) : front;
}

struct Outcome {
  std::string wrong;  // empty when all is well
  std::vector<unsigned> patterns;
  bool isEmpty = false;
};

std::string whatIsWrongWith(const RandomDomain& domain, const RepairedFront& front) {
  if (!isComplete(domain.tree) || !isBalanced(domain.tree)) return "the tree is not balanced";
  if (!frontIsPermitted(domain.tree, front.painted)) return "the front is not permitted";
  const std::string topology = checkTopology(front.mesh);
  if (!topology.empty()) return "front: " + topology;
  Monitor monitor;
  const PolyMesh layer = dummyLayer(front.mesh, {}, monitor);
  const auto walls = std::count_if(front.mesh.patch.begin(), front.mesh.patch.end(),
                                   [&](Id p) { return front.mesh.isWallPatch(p); });
  if (layer.cellCount != front.mesh.cellCount + walls) return "not one prism on each front face";
  return whatIsWrong(layer);
}

Outcome tryDomain(unsigned seed) {
  Outcome outcome;
  try {
    const RandomDomain domain = randomDomain(seed, stretchOf(seed));
    const RepairedFront front = repairedFront(domain, seed % 2);
    outcome.isEmpty = front.mesh.cellCount == 0;
    if (outcome.isEmpty) return outcome;
    outcome.patterns = frontPatterns(domain.tree, front.painted);
    outcome.wrong = whatIsWrongWith(domain, front);
  } catch (const std::exception& e) {
    outcome.wrong = e.what();
  }
  return outcome;
}

TEST(RandomFronts, EveryPermittedPatternGetsAValidLayer) {
  std::vector<Outcome> outcomes(kDomains);
  tbb::parallel_for(0u, kDomains, [&](unsigned seed) { outcomes[seed] = tryDomain(seed); });
  std::set<unsigned> seen;
  unsigned empty = 0;
  for (unsigned seed = 0; seed < kDomains; ++seed) {
    EXPECT_EQ(outcomes[seed].wrong, "") << "domain " << seed;
    seen.insert(outcomes[seed].patterns.begin(), outcomes[seed].patterns.end());
    empty += outcomes[seed].isEmpty;
  }
  for (unsigned pattern = 0; pattern < 256; ++pattern)
    EXPECT_EQ(seen.count(pattern) == 1, isPermittedPattern(pattern)) << "pattern " << pattern;
  EXPECT_LT(empty, kDomains / 5);
}

/// Random moves of all kinds, with a record of where every point must be.
class Storm {
 public:
  Storm(PolyMesh& mesh, unsigned seed) : mesh_(mesh), mover_(mesh, {}), g_(seed), expected_(mesh.points) {}

  void rage(unsigned moves) {
    for (unsigned i = 0; i < moves; ++i) {
      attempt();
      ASSERT_TRUE(mesh_.points == expected_) << "a point is not where the mover said";
    }
  }
  /// The caches equal those of a mover that has seen nothing but the result.
  void expectFreshCaches() {
    const NodeMover fresh(mesh_, {});
    for (Id f = 0; f < mesh_.faceCount(); ++f) {
      EXPECT_EQ(mover_.faceCentre(f), fresh.faceCentre(f));
      EXPECT_EQ(mover_.faceNormal(f), fresh.faceNormal(f));
    }
    for (Id c = 0; c < mesh_.cellCount; ++c) EXPECT_EQ(mover_.cellCentre(c), fresh.cellCentre(c));
    for (Id p = 0; p < static_cast<Id>(mesh_.points.size()); ++p)
      EXPECT_EQ(mover_.badness(p), fresh.badness(p));
  }
  /// Points drift to far targets in ever smaller steps until their limits are met to the last digits.
  void press(unsigned points) {
    for (unsigned i = 0; i < points; ++i) {
      const Id p = anyPoint();
      const Vec3 to = mesh_.points[p] + 3 * mesh_.finestSize * randomPoint(g_, -1, 1).normalized();
      Vec3 from = to;
      for (int step = 0; step < 60 && from != mesh_.points[p]; ++step) {
        from = mesh_.points[p];
        mover_.drift(p, to, 40);
      }
    }
    expected_ = mesh_.points;
  }
  unsigned kept = 0, refused = 0;

 private:
  Id anyPoint() { return static_cast<Id>(g_() % mesh_.points.size()); }
  Vec3 target(Id p) {
    const double reach = std::pow(10.0, randomPoint(g_, -3, 0)[0]) * mesh_.finestSize;
    return mesh_.points[p] + reach * randomPoint(g_, -1, 1);
  }
  void expect(Id p, const Vec3& at) {
    for (int a = 0; a < 3; ++a)
      if (!(mesh_.fixed[p] >> a & 1)) expected_[p][a] = at[a];
  }
  void attempt() {
    const Id p = anyPoint();
    const Vec3 from = mesh_.points[p], to = target(p);
    const double badness = mover_.badness(p);
    double part = 0;
    switch (g_() % 6) {
      case 0:
        part = mover_.move(p, to);
        break;
      case 1:
        part = mover_.moveIf(p, to, [&] { return mover_.point(p)[0] < from[0]; });
        break;
      case 2:
        part = mover_.drift(p, to);
        break;
      case 3:
        part = mover_.improve(p, to);
        EXPECT_LE(mover_.badness(p), badness);
        break;
      default:
        return together(g_() % 2);
    }
    (part > 0 ? kept : refused) += 1;
    if (part > 0) expect(p, from + part * (to - from));
  }
  /// Two to six points around a cell at once.
  void together(bool mustImprove) {
    const Span<Id> around = mover_.pointsOf(static_cast<Id>(g_() % mesh_.cellCount));
    std::vector<Id> points;
    for (std::size_t k = 0; k < 2 + g_() % 5; ++k) points.push_back(around[g_() % around.size()]);
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::vector<Vec3> targets;
    for (Id p : points) targets.push_back(target(p));
    const bool ok =
        mustImprove ? mover_.improveTogether(points, targets) : mover_.moveTogether(points, targets);
    (ok ? kept : refused) += 1;
    for (std::size_t i = 0; ok && i < points.size(); ++i) expect(points[i], targets[i]);
  }

  PolyMesh& mesh_;
  NodeMover mover_;
  std::mt19937_64 g_;
  std::vector<Vec3> expected_;
};

TEST(RandomFronts, StormsOfMovesLeaveValidMeshesAndTrueCaches) {
  unsigned kept = 0, refused = 0, meshes = 0;
  for (unsigned seed = 0; meshes < kStormyMeshes; ++seed) {
    PolyMesh mesh = layerOn(seed);
    if (mesh.cellCount == 0) continue;
    ++meshes;
    Storm storm(mesh, seed);
    for (unsigned round = 0; round < kStorms; ++round) {
      storm.rage(kMovesInAStorm);
      storm.press(kPressedPoints);
      ASSERT_EQ(whatIsWrong(mesh), "") << "domain " << seed;
      storm.expectFreshCaches();
      ASSERT_FALSE(HasFailure()) << "domain " << seed;
    }
    kept += storm.kept;
    refused += storm.refused;
  }
  EXPECT_GT(kept, kStormyMeshes * kStorms * kMovesInAStorm / 10);
  EXPECT_GT(refused, kStormyMeshes * kStorms * kMovesInAStorm / 10);
}

/// Every point and every prism edge tries moves that depend on the point, the sweep and where it is.
std::vector<Vec3> sweptPoints(PolyMesh mesh, int threads) {
  withThreads(threads, [&] {
    NodeMover mover(mesh, {});
    const auto groups = mover.colour(allPoints(mesh));
    for (unsigned sweep = 0; sweep < 6; ++sweep)
      mover.forEach(groups, [&](Id p) {
        randomMove(mover, mesh, p, 97 * static_cast<unsigned>(p) + sweep, sweep % 3);
      });
    EXPECT_EQ(whatIsWrong(mesh), "");
  });
  return mesh.points;
}

TEST(RandomFronts, SweepsInColoursGiveTheSameBitsOnAnyNumberOfThreads) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const PolyMesh mesh = layerOn(seed);
    if (mesh.cellCount == 0) continue;
    const std::vector<Vec3> one = sweptPoints(mesh, 1);
    EXPECT_TRUE(one == sweptPoints(mesh, 2)) << "domain " << seed;
    EXPECT_TRUE(one == sweptPoints(mesh, 4)) << "domain " << seed;
    for (std::size_t p = 0; p < one.size(); ++p) moved += one[p] != mesh.points[p];
  }
  EXPECT_GT(moved, 1000u);
}

}  // namespace
