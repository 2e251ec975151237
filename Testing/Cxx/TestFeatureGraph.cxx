// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "FeatureEdges.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::cube;
using testing::randomPoint;

FeatureGraph everyEdgeOf(const testing::Soup& soup) {
  FeatureOptions options;
  options.openEdges = true;
  return detectFeatures(*soup.model(), options);
}

TEST(FeatureGraph, ClosestEqualsBruteForce) {
  const FeatureGraph graph = everyEdgeOf(testing::randomSoup(400, 0.2, 12));
  ASSERT_GT(graph.segments().size(), 1000u);
  const auto distance2 = [&](const Vec3& p, const FeatureSegment& s) {
    const Vec3 d = s.b - s.a;
    return (s.a + std::clamp((p - s.a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d - p).squaredNorm();
  };
  std::mt19937_64 generator(13);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = i % 3 ? randomPoint(generator, -1, 2) : graph.segments()[i].a;
    double best = std::numeric_limits<double>::infinity(), bestOnCurve = best;
    const Id curve = static_cast<Id>(generator() % graph.curves().size());
    for (const FeatureSegment& s : graph.segments()) {
      best = std::min(best, distance2(p, s));
      if (s.curve == curve) bestOnCurve = std::min(bestOnCurve, distance2(p, s));
    }
    const ClosestOnFeature found = graph.closest(p), onCurve = graph.closestOnCurve(p, curve);
    EXPECT_NEAR(found.distance2, best, 1e-13);
    EXPECT_NEAR((found.point - p).squaredNorm(), best, 1e-13);
    EXPECT_NEAR(distance2(p, graph.segments().at(found.segment)), best, 1e-13);
    EXPECT_NEAR(onCurve.distance2, bestOnCurve, 1e-13);
    EXPECT_EQ(graph.segments().at(onCurve.segment).curve, curve);
    if (best == 0) continue;
    EXPECT_EQ(graph.closest(p, 0.99 * std::sqrt(best)).segment, kNone);
    EXPECT_EQ(graph.closest(p, 1.01 * std::sqrt(best)).segment, found.segment);
  }
}

TEST(FeatureGraph, TiesGoToTheSmallestSegment) {
  const FeatureGraph graph = everyEdgeOf(cube(7));
  for (const Vec3& corner : graph.corners()) {
    const Vec3 p = 2 * corner - Vec3(0.5, 0.5, 0.5);
    Id first = kNone;
    for (Id s = static_cast<Id>(graph.segments().size()) - 1; s >= 0; --s)
      if (graph.segments()[s].a == corner || graph.segments()[s].b == corner) first = s;
    EXPECT_EQ(graph.closest(p).segment, first);
    EXPECT_EQ(graph.closest(p).point, corner);
  }
}

TEST(FeatureGraph, SegmentsNearEqualsBruteForce) {
  const FeatureGraph graph = everyEdgeOf(testing::randomSoup(300, 0.2, 14));
  std::mt19937_64 generator(15);
  for (int i = 0; i < 100; ++i) {
    Box box;
    box.add(randomPoint(generator, -0.2, 1.2));
    box.add(box.lo + randomPoint(generator, 0, 0.3));
    std::vector<Id> expected;
    for (std::size_t s = 0; s < graph.segments().size(); ++s) {
      Box own;
      own.add(graph.segments()[s].a);
      own.add(graph.segments()[s].b);
      if (own.overlaps(box)) expected.push_back(static_cast<Id>(s));
    }
    EXPECT_EQ(graph.segmentsNear(box), expected);
  }
}

TEST(FeatureGraph, EmptyGraphAnswersNothing) {
  const FeatureGraph graph({}, {}, {});
  EXPECT_EQ(graph.closest({0, 0, 0}).segment, kNone);
  Box box;
  box.add({0, 0, 0});
  EXPECT_TRUE(graph.segmentsNear(box).empty());
}

TEST(FeatureGraph, RefusesSegmentsOutOfOrder) {
  std::vector<FeatureCurve> curves(2);
  for (FeatureCurve& c : curves) c.points = {{0, 0, 0}, {1, 0, 0}};
  const FeatureSegment first{{0, 0, 0}, {1, 0, 0}, 0, kSharpEdge},
      second{{0, 0, 0}, {1, 0, 0}, 1, kSharpEdge};
  EXPECT_NO_THROW(FeatureGraph({}, curves, {first, second}));
  EXPECT_THROW(FeatureGraph({}, curves, {second, first}), InternalError);
  FeatureSegment stray = second;
  stray.curve = 2;
  EXPECT_THROW(FeatureGraph({}, curves, {first, stray}), InternalError);
}

}  // namespace
}  // namespace pm
