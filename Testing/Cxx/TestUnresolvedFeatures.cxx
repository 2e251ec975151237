// SPDX-License-Identifier: BSD-3-Clause
// What Resolve Features says about the features that it could not resolve, and features given as polylines.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "DummyLayer.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "Project.h"
#include "ResolveFeatures.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::Soup;

struct Outcome {
  std::unique_ptr<SurfaceModel> model;
  PolyMesh mesh;
  ResolveFeaturesReport report;
};

Outcome resolve(const Soup& soup, double size, const ResolveFeaturesOptions& options = {},
                Region region = Region::Inside) {
  Outcome r;
  r.model = soup.model();
  Monitor monitor;
  OctreeDecomposeOptions octree;
  octree.featureSize = size;
  PaintFrontOptions front;
  front.region = region;
  r.mesh =
      dummyLayer(paintFront(decompose(*r.model, octree, monitor), *r.model, front, monitor), {}, monitor);
  DistanceField field(*r.model, r.mesh.finestSize);
  project(r.mesh, field, {}, monitor);
  resolveFeatures(r.mesh, field, options, monitor, &r.report);
  return r;
}

double lengthOf(const ResolveFeaturesReport& report, Unresolved why) {
  double sum = 0;
  for (const UnresolvedFeature& part : report.unresolved)
    if (part.why == why) sum += part.length;
  return sum;
}

/// Every part is as long as its polyline, and all of them make up what is not resolved, to rounding at ends.
void expectComplete(const Outcome& run) {
  double sum = 0;
  for (const UnresolvedFeature& part : run.report.unresolved) {
    double length = 0;
    for (std::size_t i = 1; i < part.points.size(); ++i)
      length += (part.points[i] - part.points[i - 1]).norm();
    EXPECT_NEAR(part.length, length, 1e-9);
    EXPECT_EQ(part.why == Unresolved::Limit, part.limit != Refusal::None);
    sum += part.length;
  }
  const double lost = run.report.featureLength - run.report.resolvedLength;
  EXPECT_LE(sum, lost + 1e-9);
  EXPECT_GE(sum, lost - 0.1 * run.mesh.finestSize * static_cast<double>(run.report.unresolved.size() + 8));
}

/// A closed prism over a polygon, from z = 0 to 1.
Soup prism(const std::vector<std::array<double, 2>>& polygon) {
  Soup s;
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i, double z) { return Vec3(polygon[i % n][0], polygon[i % n][1], z); };
  for (std::size_t i = 0; i < n; ++i) {
    s.add(at(i, 0), at(i + 1, 0), at(i + 1, 1));
    s.add(at(i, 0), at(i + 1, 1), at(i, 1));
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    s.add(at(0, 0), at(i + 1, 0), at(i, 0));
    s.add(at(0, 1), at(i, 1), at(i + 1, 1));
  }
  return s;
}

TEST(UnresolvedFeatures, NoneOnABox) {
  const Outcome run = resolve(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 0.1);
  expectComplete(run);
  EXPECT_GT(run.report.resolvedLength, 11.9);
  EXPECT_TRUE(run.report.unresolved.empty());
}

TEST(UnresolvedFeatures, EdgesCloserThanTheCells) {
  // Four steps of a tenth of a cell in one side of a box: eight lines in half a cell.
  const double step = 0.01;
  std::vector<std::array<double, 2>> outline{{0, 0}, {1, 0}};
  for (int k = 0; k < 4; ++k) {
    outline.push_back({1 - k * step, 0.5 + k * step});
    outline.push_back({1 - (k + 1) * step, 0.5 + k * step});
  }
  outline.push_back({1 - 4 * step, 1});
  outline.push_back({0, 1});
  const Outcome run = resolve(prism(outline), 0.1);
  expectComplete(run);
  const double close = lengthOf(run.report, Unresolved::TooClose);
  EXPECT_GT(close, 3);  // more than three of the lines, which cannot all be followed
  for (const UnresolvedFeature& part : run.report.unresolved)
    if (part.why == Unresolved::TooClose && part.length > 0.3) {
      EXPECT_NEAR(part.size, step, 1e-9);
    }
}

TEST(UnresolvedFeatures, WedgesTooAcuteForCells) {
  const Outcome run = resolve(prism({{0, 0}, {2, 0}, {2, 0.5}}), 0.1);
  expectComplete(run);
  const double acute = lengthOf(run.report, Unresolved::Acute);  // the tip: 14 degrees, and a bit at its ends
  EXPECT_GT(acute, 0.95);
  EXPECT_LT(acute, 1.3);
}

TEST(UnresolvedFeatures, PartsInsideOthersAreNotOnTheWall) {
  Soup both = prism({{0, 0}, {3, 0}, {3, 3}, {0, 3}});
  Soup inner = prism({{1, 1}, {2, 1}, {2, 2}, {1, 2}});
  for (std::size_t t = 0; t < inner.triangles.size(); ++t) {
    const auto& [a, b, c] = inner.triangles[t];
    const auto shrunk = [&](Id p) -> Vec3 { return 0.5 * inner.points[p] + Vec3(0.75, 0.75, 0.25); };
    both.add(shrunk(a), shrunk(b), shrunk(c));
  }
  const Outcome run = resolve(both, 0.15, {}, Region::Outside);
  expectComplete(run);
  EXPECT_NEAR(lengthOf(run.report, Unresolved::NotOnWall), 6, 1e-6);  // the edges of the inner box
}

TEST(UnresolvedFeatures, GivenCurvesAreFollowed) {
  const Soup box = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  ResolveFeaturesOptions options;
  options.features.given = {{Vec3(0, 0.3, 1), Vec3(0.4, 0.55, 1), Vec3(1, 0.62, 1)}};
  const Outcome run = resolve(box, 0.1, options);
  expectComplete(run);
  const double length = std::hypot(0.4, 0.25) + std::hypot(0.6, 0.07);
  EXPECT_NEAR(run.report.featureLength, 12 + length, 1e-9);
  EXPECT_GT(run.report.resolvedLength, 0.97 * (12 + length));
  EXPECT_EQ(run.report.corners, 8 + 2);  // its ends lie on edges of the box
  EXPECT_EQ(run.report.resolvedCorners, run.report.corners);
}

TEST(UnresolvedFeatures, GivenCurvesOnEdgesAddNothing) {
  const Soup box = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  FeatureOptions options;
  options.gapTolerance = 1e-3;
  options.given = {{Vec3(0, 0, 0), Vec3(1, 0, 0)}, {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1)}};
  const FeatureGraph graph = detectFeatures(*box.model(), options);
  EXPECT_EQ(graph.curves().size(), 12u);
  for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind & kGivenEdge, 0);
}

TEST(UnresolvedFeatures, GivenLoopsStayClosed) {
  const Soup box = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  FeatureOptions options;
  std::vector<Vec3> loop;
  for (int i = 0; i <= 40; ++i) {
    const double t = 2 * M_PI * (i % 40) / 40;
    loop.emplace_back(0.5 + 0.3 * std::cos(t), 0.5 + 0.3 * std::sin(t), 1);
  }
  options.given = {loop};
  const FeatureGraph graph = detectFeatures(*box.model(), options);
  ASSERT_EQ(graph.curves().size(), 13u);
  int closed = 0;
  for (const FeatureCurve& curve : graph.curves()) closed += curve.closed;
  EXPECT_EQ(closed, 1);
}

TEST(UnresolvedFeatures, GivenCurvesMustBeNumbers) {
  const Soup box = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  FeatureOptions options;
  options.given = {{Vec3(0, 0, 0), Vec3(std::nan(""), 0, 0)}};
  EXPECT_THROW(detectFeatures(*box.model(), options), InputError);
}

}  // namespace
}  // namespace pm
