// SPDX-License-Identifier: BSD-3-Clause
// New nodes where a feature found none.
#include "FeatureBridges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "LayerColumns.h"
#include "TestMeshes.h"
#include "TestRandomDomains.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// A roof of two planes with its ridge above y = 2 x - 1, so that it runs from node to node over the middle
/// of an edge between two faces.
double roofHeight(double x, double y) { return 1.1 - 0.3 * std::abs(2 * x - 1 - y) / std::sqrt(5); }

PolyMesh roofedBlock() {
  VoxelOptions o;
  o.size = {4, 4, 2};
  o.wallSide = {false, false, false, false, false, true};
  o.deform = [](const Vec3& p) {
    return p.z() <= 2 ? p : Vec3(p.x(), p.y(), p.z() + roofHeight(p.x(), p.y()));
  };
  return layeredVoxels(o);
}

std::unique_ptr<SurfaceModel> roof() {
  const auto at = [](double x, double y) { return Vec3(x, y, 2 + 1. / 3 + roofHeight(x, y)); };
  Soup soup;
  soup.add(at(0, 0), at(0.5, 0), at(2.5, 4));
  soup.add(at(0, 0), at(2.5, 4), at(0, 4));
  soup.add(at(0.5, 0), at(4, 0), at(4, 4));
  soup.add(at(0.5, 0), at(4, 4), at(2.5, 4));
  return soup.model();
}

class RidgeBetweenNodes : public ::testing::Test {
 protected:
  RidgeBetweenNodes() : model_(roof()), field_(*model_, 1), graph_(detectFeatures(*model_, {})) {}

  /// Bridges between the nodes above these places, taken to lie on the ridge.
  BridgesBuilt build(PolyMesh& mesh, const std::vector<Eigen::Vector2d>& places, bool seen = true) {
    const WallSurface wall = wallSurface(mesh);
    PathHistory held;
    held.curve.assign(wall.nodes.size(), kNone);
    held.corner = held.curve;
    for (Id row = 0; row < wall.size(); ++row)
      for (const Eigen::Vector2d& place : places)
        if (mesh.points[wall.nodes[row]].head<2>() == place) held.curve[row] = 0;
    const QualityLimits limits;
    const auto sees = [&](const Vec3&, const Vec3&) { return seen; };
    return bridgeGaps(mesh, {wall, field_, graph_, held, limits, sees}, hopeless_);
  }
  std::vector<Id> bridge(PolyMesh& mesh, const std::vector<Eigen::Vector2d>& places, bool seen = true) {
    return build(mesh, places, seen).curves;
  }

  std::unique_ptr<SurfaceModel> model_;
  DistanceField field_;
  FeatureGraph graph_;
  std::set<GapKey> hopeless_;
};

TEST_F(RidgeBetweenNodes, GetsANodeAndBothEdges) {
  PolyMesh mesh = roofedBlock();
  ASSERT_EQ(whatIsWrong(mesh), "");
  ASSERT_EQ(graph_.curves().size(), 1u);
  const Id cells = mesh.cellCount;
  ASSERT_EQ(bridge(mesh, {{1, 1}, {2, 3}}), std::vector<Id>{0});
  EXPECT_EQ(whatIsWrong(mesh), "");
  EXPECT_EQ(mesh.cellCount, cells + 2);
  const WallSurface wall = wallSurface(mesh);
  const Id row = wall.size() - 1;  // new points come last, the wall's before its base
  const Vec3& p = mesh.points[wall.nodes[row]];
  EXPECT_LT(graph_.closest(p).distance2, 1e-6);
  int onRidge = 0;
  for (Id n : wall.neighbours[row]) onRidge += graph_.closest(mesh.points[wall.nodes[n]]).distance2 < 1e-6;
  EXPECT_EQ(onRidge, 2);
  const LayerColumns columns(mesh);
  for (Id c = 0; c < columns.count(); ++c) EXPECT_TRUE(columns.canSplit(c));
}

TEST_F(RidgeBetweenNodes, IsBridgedOverOneFaceWithoutANewNode) {
  PolyMesh mesh = roofedBlock();
  const Id cells = mesh.cellCount;
  const BridgesBuilt built = build(mesh, {{1, 1}, {2, 2}});
  EXPECT_EQ(built.count, 1u);
  EXPECT_TRUE(built.curves.empty());
  EXPECT_EQ(mesh.cellCount, cells + 1);
  EXPECT_EQ(whatIsWrong(mesh), "");
}

TEST_F(RidgeBetweenNodes, StaysAsItIsWithoutAGapOrASight) {
  const PolyMesh before = roofedBlock();
  for (const auto& [places, seen] : std::vector<std::pair<std::vector<Eigen::Vector2d>, bool>>{
           {{}, true}, {{{1, 1}}, true}, {{{1, 1}, {2, 3}}, false}}) {
    PolyMesh mesh = before;
    EXPECT_TRUE(bridge(mesh, places, seen).empty());
    EXPECT_EQ(checksum(mesh), checksum(before));
  }
}

TEST_F(RidgeBetweenNodes, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::uint64_t> sums;
  for (int threads : {1, 4})
    withThreads(threads, [&] {
      PolyMesh mesh = roofedBlock();
      EXPECT_EQ(bridge(mesh, {{1, 1}, {2, 3}}).size(), 1u);
      sums.push_back(checksum(mesh));
    });
  EXPECT_EQ(sums[0], sums[1]);
}

}  // namespace
