// SPDX-License-Identifier: BSD-3-Clause
// New nodes in wall edges that are chords.
#include "ChordSplits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "LayerColumns.h"
#include "TestMeshes.h"
#include "TestRandomDomains.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// A roof of two planes with its ridge above x = 1.5, where the nodes lie above whole numbers.
double roofHeight(double x) { return 1.1 - 0.3 * std::abs(x - 1.5); }

PolyMesh roofedBlock() {
  VoxelOptions o;
  o.size = {4, 4, 2};
  o.wallSide = {false, false, false, false, false, true};
  o.deform = [](const Vec3& p) { return p.z() <= 2 ? p : Vec3(p.x(), p.y(), p.z() + roofHeight(p.x())); };
  return layeredVoxels(o);
}

std::unique_ptr<SurfaceModel> roof() {
  const auto at = [](double x, double y) { return Vec3(x, y, 2 + 1. / 3 + roofHeight(x)); };
  Soup soup;
  for (double x : {0.0, 1.5}) {
    const double to = x == 0 ? 1.5 : 4;
    soup.add(at(x, 0), at(to, 0), at(to, 4));
    soup.add(at(x, 0), at(to, 4), at(x, 4));
  }
  return soup.model();
}

class RidgeAcrossEdges : public ::testing::Test {
 protected:
  RidgeAcrossEdges() : model_(roof()), field_(*model_, 1), graph_(detectFeatures(*model_, {})) {}

  /// curve: that all nodes are taken to lie on.
  std::vector<Id> split(PolyMesh& mesh, Id curve = kNone, bool seen = true) {
    const WallSurface wall = wallSurface(mesh);
    PathHistory held;
    held.curve.assign(wall.nodes.size(), curve);
    held.corner.assign(wall.nodes.size(), kNone);
    const QualityLimits limits;
    const auto sees = [&](const Vec3&, const Vec3&) { return seen; };
    return splitChords(mesh, {wall, field_, graph_, held, limits, sees});
  }

  std::unique_ptr<SurfaceModel> model_;
  DistanceField field_;
  FeatureGraph graph_;
};

TEST_F(RidgeAcrossEdges, GetsNodesOnTheGeometryAndColumnsBetweenThem) {
  PolyMesh mesh = roofedBlock();
  ASSERT_EQ(whatIsWrong(mesh), "");
  const Id cells = mesh.cellCount;
  const std::size_t points = mesh.points.size();
  // The outermost two of five edges have the domain's side below them, and stay.
  ASSERT_EQ(split(mesh), std::vector<Id>(3, kNone));
  EXPECT_EQ(whatIsWrong(mesh), "");
  EXPECT_EQ(mesh.cellCount, cells + 2);
  ASSERT_EQ(mesh.points.size(), points + 6);
  for (std::size_t p = points; p < mesh.points.size(); p += 2) {
    EXPECT_LT(model_->closest(mesh.points[p]).distance2, 1e-12);
    EXPECT_EQ(mesh.base[p], static_cast<Id>(p + 1));
  }
  const LayerColumns columns(mesh);
  for (Id c = 0; c < columns.count(); ++c) EXPECT_TRUE(columns.canSplit(c));
}

TEST_F(RidgeAcrossEdges, DrawsTheMiddleOfNodesOnACurveToThatCurve) {
  PolyMesh mesh = roofedBlock();
  ASSERT_EQ(graph_.curves().size(), 1u);
  const std::size_t points = mesh.points.size();
  const std::vector<Id> curves = split(mesh, 0);
  ASSERT_GE(curves.size(), 3u);
  EXPECT_EQ(whatIsWrong(mesh), "");
  int onRidge = 0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    EXPECT_EQ(curves[i], 0);
    onRidge += graph_.closest(mesh.points[points + 2 * i]).distance2 < 1e-12;
  }
  EXPECT_EQ(onRidge, 3);
}

TEST_F(RidgeAcrossEdges, StayWhereTheGeometryIsOutOfSight) {
  PolyMesh mesh = roofedBlock();
  EXPECT_TRUE(split(mesh, kNone, false).empty());
  EXPECT_EQ(checksum(mesh), checksum(roofedBlock()));
}

TEST_F(RidgeAcrossEdges, AreSplitOnceOnly) {
  PolyMesh mesh = roofedBlock();
  split(mesh, 0);
  const std::uint64_t once = checksum(mesh);
  EXPECT_TRUE(split(mesh).empty());
  EXPECT_EQ(checksum(mesh), once);
}

TEST_F(RidgeAcrossEdges, GiveTheSameBitsForAnyNumberOfThreads) {
  std::vector<std::uint64_t> sums;
  for (int threads : {1, 4})
    withThreads(threads, [&] {
      PolyMesh mesh = roofedBlock();
      EXPECT_EQ(split(mesh).size(), 3u);
      sums.push_back(checksum(mesh));
    });
  EXPECT_EQ(sums[0], sums[1]);
}

}  // namespace
