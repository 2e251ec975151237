// SPDX-License-Identifier: BSD-3-Clause
// Curves where the surface cuts itself, as features.
#include <gtest/gtest.h>

#include <cmath>

#include "FeatureEdges.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::cube;
using testing::Soup;

Soup shifted(const Soup& soup, const Vec3& by, double scale = 1) {
  return soup.mapped([&](const Vec3& p) { return Vec3(scale * p + by); });
}

double lengthOf(const FeatureGraph& graph, int kind) {
  double sum = 0;
  for (const FeatureSegment& s : graph.segments())
    if (s.kind & kind) sum += (s.b - s.a).norm();
  return sum;
}

TEST(FeatureIntersections, TwoCubesCutInAHexagon) {
  for (int n : {1, 4}) {
    Soup soup = cube(n);
    soup.append(shifted(cube(n + 1), {0.5, 0.5, 0.5}));
    const FeatureGraph graph = detectFeatures(*soup.model(), {});
    EXPECT_NEAR(lengthOf(graph, kIntersectionEdge), 3, 1e-12);
    EXPECT_NEAR(lengthOf(graph, kSharpEdge), 24, 1e-12);
    // The hexagon's corners lie on edges of the cubes, three each, and cut them in two.
    EXPECT_EQ(graph.corners().size(), 16u + 6u);
    EXPECT_EQ(graph.curves().size(), 24u + 6u + 6u);
    FeatureOptions off;
    off.intersections = false;
    EXPECT_EQ(detectFeatures(*soup.model(), off).curves().size(), 24u);
  }
}

TEST(FeatureIntersections, SizeAndPlaceDoNotMatter) {
  Soup soup = cube(3);
  soup.append(shifted(cube(4), {0.4, 0.3, 0.6}));
  for (const auto& [scale, offset] :
       {std::pair{1e-30, Vec3(0, 0, 0)}, {1e30, Vec3(0, 0, 0)}, {10.0, Vec3(5.5e5, 4.75e6, 100)}}) {
    const FeatureGraph graph = detectFeatures(*shifted(soup, offset, scale).model(), {});
    EXPECT_NEAR(lengthOf(graph, kIntersectionEdge), 2 * scale * (0.6 + 0.7 + 0.4), 1e-8 * scale);
    EXPECT_EQ(graph.corners().size(), 22u);
    EXPECT_EQ(graph.curves().size(), 36u);
  }
}

TEST(FeatureIntersections, CylinderThroughAPlateIsAClosedCurve) {
  Soup soup = testing::cylinder(40);
  const double middle = 0.5 * soup.model()->bounds().lo[2] + 0.5 * soup.model()->bounds().hi[2] + 0.1;
  soup.addGrid({-3, -3, middle}, {6, 0, 0.3}, {0, 6, 0.2}, 7);
  const FeatureGraph graph = detectFeatures(*soup.model(), {});
  int loops = 0;
  for (const FeatureCurve& c : graph.curves()) loops += c.closed;
  EXPECT_EQ(loops, 3);  // two rims and the cut
  EXPECT_TRUE(graph.corners().empty());
  EXPECT_NEAR(lengthOf(graph, kIntersectionEdge), 2 * 3.14159265358979, 0.05);
}

TEST(FeatureIntersections, SharpAngleDecides) {
  for (double degrees : {5.0, 29.0, 31.0, 90.0}) {
    const double a = degrees * 3.14159265358979323846 / 180;
    Soup soup;
    soup.addGrid({-1, 0, 0}, {2, 0, 0}, {0, 1, 0}, 4);
    const Vec3 across(std::cos(a), 0, std::sin(a));
    soup.addGrid(Vec3(0, 0.013, 0) - 0.5 * across, across, {0, 0.9, 0}, 5);
    const FeatureGraph graph = detectFeatures(*soup.model(), {});
    EXPECT_EQ(graph.segments().empty(), degrees < 30) << degrees;
    EXPECT_NEAR(lengthOf(graph, kIntersectionEdge), degrees < 30 ? 0 : 0.9, 1e-12);
  }
}

TEST(FeatureIntersections, ASunkBoxHasOneRimNotTwo) {
  // The box stands 1e-4 deep in the plate: its lower edges and the cut are one line for a coarser mesh.
  Soup soup = cube(4);
  soup.addGrid({-1, -1, 1e-4}, {3, 0, 0}, {0, 3, 0}, 5);
  FeatureOptions options;
  options.gapTolerance = 1e-3;
  const FeatureGraph coarse = detectFeatures(*soup.model(), options);
  EXPECT_EQ(lengthOf(coarse, kIntersectionEdge), 0);
  EXPECT_EQ(coarse.curves().size(), 12u);
  options.gapTolerance = 0;
  const FeatureGraph fine = detectFeatures(*soup.model(), options);
  EXPECT_NEAR(lengthOf(fine, kIntersectionEdge), 4, 1e-12);
}

TEST(FeatureIntersections, PiecesBelowTheToleranceAreNoFeatures) {
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3);
  soup.add({0.5, 0.5, -0.01}, {0.51, 0.52, 0.3}, {0.5, 0.51, 0.3});
  FeatureOptions options;
  EXPECT_EQ(detectFeatures(*soup.model(), options).curves().size(), 1u);
  options.gapTolerance = 0.01;
  EXPECT_TRUE(detectFeatures(*soup.model(), options).curves().empty());
  options.gapTolerance = 0;
  options.shortestCurve = 0.01;
  EXPECT_TRUE(detectFeatures(*soup.model(), options).curves().empty());
}

TEST(FeatureIntersections, CurvesEndOnOpenEdges) {
  // A fin that stands half in a plate: the cut runs from the plate's border to the fin's end.
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3);
  soup.addGrid({-0.5, 0.41, -0.5}, {1, 0, 0}, {0, 0.05, 1}, 4);
  FeatureOptions options;
  options.openEdges = true;
  const FeatureGraph graph = detectFeatures(*soup.model(), options);
  EXPECT_NEAR(lengthOf(graph, kIntersectionEdge), 0.5, 1e-12);
  EXPECT_NEAR(lengthOf(graph, kOpenEdge), 4 + 2 + 2 * std::hypot(1, 0.05), 1e-12);
  EXPECT_EQ(graph.corners().size(), 8u + 2u);
  int cuts = 0;
  for (const FeatureSegment& s : graph.segments()) {
    if (s.kind != kIntersectionEdge) continue;
    const FeatureCurve& curve = graph.curves().at(s.curve);
    ++cuts;
    EXPECT_NEAR(curve.length(), 0.5, 1e-12);
    EXPECT_NE(curve.startCorner, kNone);
  }
  EXPECT_GT(cuts, 0);
}

TEST(FeatureIntersections, SameForAnyNumberOfThreads) {
  const auto model = testing::randomSoup(1500, 0.2, 4, 6).model();
  FeatureOptions options;
  options.gapTolerance = 1e-3;
  const auto detect = [&](int threads) {
    std::vector<Vec3> ends;
    testing::withThreads(threads, [&] {
      const FeatureGraph graph = detectFeatures(*model, options);
      for (const FeatureSegment& s : graph.segments()) ends.insert(ends.end(), {s.a, s.b});
    });
    return ends;
  };
  const std::vector<Vec3> one = detect(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, detect(4));
}

}  // namespace
}  // namespace pm
