// SPDX-License-Identifier: BSD-3-Clause
// How deep cells on critical edges are split as needed.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "RefineReason.h"
#include "TestOctrees.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kDegree = 3.14159265358979323846 / 180;

OctreeDecomposeOptions onlySharpEdges() {
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  o.featureDepth = FeatureDepth::AsNeeded;
  o.refineOpen = OpenEdgeRefinement::None;
  return o;
}

TEST(FeatureDepth, AsNeeded) {
  const auto model = cube().model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.02;
  const Octree needed = run(*model, o);
  o.featureDepth = FeatureDepth::Full;
  const Octree full = run(*model, o);
  EXPECT_LT(10 * needed.size(), full.size());
  o.featureDepth = FeatureDepth::AsNeeded;
  // A bar of 0.1 by 0.1: its long edges are told apart, with a free cell between them, and no further.
  const auto bar = cube().mapped([](const Vec3& p) { return Vec3(p[0], 0.1 * p[1], 0.1 * p[2]); }).model();
  const Octree tree = run(*bar, o);
  const Vec3 onEdge(0.51, 1e-3, 1e-3);
  EXPECT_LE(edgeAt(tree, onEdge), 0.1 / 2);
  EXPECT_FALSE(tree.cut[tree.locate(Vec3(0.51, 0.05, 0.05))]);
  // The rim of a cylinder bends: as fine as the chord of a cell needs.
  const auto round = cylinder(200).model();
  o.featureSize = 0.04;
  const Octree rim = run(*round, o);
  const double h = edgeAt(rim, Vec3(1 - 1e-4, 1e-4, 1e-4));
  EXPECT_LE(h * h / 8, 2 * 0.04 / 20);  // the sag over a cell's edge, with room for its diagonal
  EXPECT_GT(h, 0.04 - 1e-12);
  const auto buffer = static_cast<std::uint8_t>(RefineReason::FeatureBuffer);
  EXPECT_GT(std::count(rim.refinedBy.begin(), rim.refinedBy.end(), buffer), 0) << "beside the rim as on it";
}

// A cube in no particular position: what asks at one place of an edge is answered along all of it.
TEST(FeatureDepth, AsNeededKeepsOneSizeAlongAnEdge) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Vec3(0.3, 0.5, 0.8).normalized()).toRotationMatrix();
  const auto model = cube().mapped([&](const Vec3& p) { return turn * p; }).model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.04;
  const Octree tree = run(*model, o);
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k) {
      std::vector<double> sizes;
      for (double t = 0.15; t < 0.86; t += 0.01) {  // at its ends another edge may ask for more
        Vec3 p;
        p[axis] = t;
        p[(axis + 1) % 3] = k & 1;
        p[(axis + 2) % 3] = k >> 1;
        sizes.push_back(edgeAt(tree, turn * p));
      }
      const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
      EXPECT_EQ(*least, *most) << "edge " << k << " along " << axis;
    }
}

// Two surfaces meet in a ridge at 35 degrees. Where they flatten out beside it, large cells would make it
// blunt; where they are plane or grow steeper, no cell does.
TEST(FeatureDepth, AsNeededKeepsShallowEdgesBetweenCurvedSurfacesSharp) {
  const OctreeDecomposeOptions o = onlySharpEdges();
  const double slope = std::tan(17.5 * kDegree);
  const auto ridge = [&](const std::function<double(double)>& fall) {
    Soup s;
    s.addGrid(Vec3(-1, 0, 0), Vec3(2, 0, 0), Vec3(0, 4, 0), 64);
    return s.mapped([&](const Vec3& p) { return Vec3(p[0], p[1], -slope * fall(std::abs(p[0]))); }).model();
  };
  const Vec3 onRidge(1e-3, 2.01, -1e-3);
  const auto edgeFor = [&](const SurfaceModel& model) { return edgeAt(run(model, o), onRidge); };
  const double plane = edgeFor(*ridge([](double x) { return x; }));
  const double steeper = edgeFor(*ridge([](double x) { return x + 0.5 * x * x; }));
  const double flatter = edgeFor(*ridge([](double x) { return 0.1 * (1 - std::exp(-x / 0.1)); }));
  EXPECT_GT(plane, 0.3);
  EXPECT_EQ(steeper, plane);
  EXPECT_LT(flatter, 0.14);  // 20 of 35 degrees are left over a width of 0.13
  EXPECT_GT(flatter, 0.03);
}

TEST(FeatureDepth, AsNeededSplitsAcuteEdgesToTheFinest) {
  OctreeDecomposeOptions o = onlySharpEdges();
  o.separate = true;
  const auto wedge = [&](double degrees) {
    const double slope = std::tan(degrees * kDegree);
    Soup s;
    s.addGrid(Vec3(0, 0, 0), Vec3(0.4, 0, 0), Vec3(0, 4, 0), 1);
    s.addGrid(Vec3(0, 0, 0), Vec3(0.4, 0, 0.4 * slope), Vec3(0, 4, 0), 1);
    return s.model();
  };
  const Vec3 onEdge(1e-3, 2.01, 1e-4);
  EXPECT_TRUE(finestAt(run(*wedge(15), o), onEdge));
  EXPECT_FALSE(finestAt(run(*wedge(60), o), onEdge));
  o.separate = false;
  EXPECT_FALSE(finestAt(run(*wedge(15), o), onEdge));
}

}  // namespace
