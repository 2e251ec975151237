// SPDX-License-Identifier: BSD-3-Clause
// Open edges of very many loose triangles: a tolerance far above their size must not cost more than a small
// one. The work of these tests grew with the square of the number of triangles otherwise.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "FeatureEdges.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::randomPoint;
using testing::Soup;

/// Pairs of tiny triangles at a right angle, thrown about; the triangles of a pair share an edge.
Soup hinges(int count, double size) {
  Soup soup;
  std::mt19937_64 generator(11);
  for (int i = 0; i < count; ++i) {
    const Vec3 at = randomPoint(generator, 0, 1);
    const Eigen::AngleAxisd turn(i, randomPoint(generator, 0.1, 1).normalized());
    const auto place = [&](double x, double y, double z) { return Vec3(at + size * (turn * Vec3(x, y, z))); };
    soup.add(place(0, 0, 0), place(1, 0, 0), place(0.5, 1, 0));
    soup.add(place(0, 0, 0), place(1, 0, 0), place(0.5, 0, 1));
  }
  return soup;
}

TEST(OpenEdges, AToleranceFarAboveTheTrianglesSizeAddsNothingToSharpEdges) {
  FeatureOptions options;
  options.intersections = false;
  options.gapTolerance = 0.2;
  const FeatureGraph graph = detectFeatures(*hinges(10000, 0.002).model(), options);
  EXPECT_EQ(graph.segments().size(), 10000u);
  for (const FeatureSegment& s : graph.segments()) {
    EXPECT_EQ(s.kind, kSharpEdge);
    EXPECT_NEAR((s.b - s.a).norm(), 0.002, 1e-12);
  }
}

TEST(OpenEdges, LooseTrianglesBelowTheToleranceBecomeASparseNet) {
  Soup soup, flat;
  std::mt19937_64 generator(12);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = randomPoint(generator, 0, 1), q = Vec3(p[0], p[1], 0);
    soup.add(p, p + randomPoint(generator, -0.001, 0.001), p + randomPoint(generator, -0.001, 0.001));
    flat.add(q, q + Vec3(0.001, 0, 0), q + Vec3(0, 0.001, 0));
  }
  FeatureOptions options;
  options.intersections = false;
  options.gapTolerance = 0.1;
  const FeatureGraph graph = detectFeatures(*soup.model(), options);
  EXPECT_FALSE(graph.segments().empty());
  for (const FeatureSegment& s : graph.segments()) {
    EXPECT_EQ(s.kind, kOpenEdge);
    EXPECT_GT((s.b - s.a).norm(), options.gapTolerance);
    EXPECT_LT((s.b - s.a).norm(), 2.1 * options.gapTolerance);
  }
  EXPECT_TRUE(
      detectFeatures(*flat.model(), options).segments().empty());  // one plane: nothing to stitch at an angle
}

}  // namespace
}  // namespace pm
