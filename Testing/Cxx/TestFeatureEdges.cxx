// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "FeatureEdges.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::cube;
using testing::randomPoint;
using testing::Soup;

FeatureGraph detect(const Soup& soup, const FeatureOptions& options = {}) {
  return detectFeatures(*soup.model(), options);
}

double totalLength(const FeatureGraph& graph) {
  double sum = 0;
  for (const FeatureCurve& c : graph.curves()) sum += c.length();
  return sum;
}

int closedCurves(const FeatureGraph& graph) {
  return static_cast<int>(std::count_if(graph.curves().begin(), graph.curves().end(),
                                        [](const FeatureCurve& c) { return c.closed; }));
}

/// What every graph promises.
void expectConsistent(const FeatureGraph& graph) {
  std::size_t segment = 0;
  for (std::size_t c = 0; c < graph.curves().size(); ++c) {
    const FeatureCurve& curve = graph.curves()[c];
    const std::size_t n = curve.points.size();
    ASSERT_GE(n, curve.closed ? 3u : 2u);
    EXPECT_EQ(curve.closed, curve.startCorner == kNone);
    EXPECT_EQ(curve.closed, curve.endCorner == kNone);
    if (!curve.closed) {
      EXPECT_EQ(graph.corners().at(curve.startCorner), curve.points.front());
      EXPECT_EQ(graph.corners().at(curve.endCorner), curve.points.back());
    }
    for (std::size_t i = 0; i < (curve.closed ? n : n - 1); ++i, ++segment) {
      const FeatureSegment& s = graph.segments().at(segment);
      EXPECT_EQ(s.curve, static_cast<Id>(c));
      EXPECT_EQ(s.a, curve.points[i]);
      EXPECT_EQ(s.b, curve.points[(i + 1) % n]);
      EXPECT_NE(s.kind, 0);
    }
  }
  EXPECT_EQ(segment, graph.segments().size());
}

void expectEqual(const FeatureGraph& a, const FeatureGraph& b) {
  EXPECT_EQ(a.corners(), b.corners());
  ASSERT_EQ(a.segments().size(), b.segments().size());
  for (std::size_t i = 0; i < a.segments().size(); ++i) {
    EXPECT_EQ(a.segments()[i].a, b.segments()[i].a);
    EXPECT_EQ(a.segments()[i].b, b.segments()[i].b);
    EXPECT_EQ(a.segments()[i].curve, b.segments()[i].curve);
    EXPECT_EQ(a.segments()[i].kind, b.segments()[i].kind);
  }
}

/// The unit cube as six sheets that do not touch: each tessellated differently and shifted by up to `gap`.
Soup unstitchedCube(double gap, bool sameTessellation = false) {
  Soup soup;
  std::mt19937_64 generator(3);
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const Vec3 shift = randomPoint(generator, -0.5, 0.5) * gap;
    const Vec3 origin = side % 2 ? Vec3(Vec3::Unit(axis)) : Vec3(Vec3::Zero());
    soup.addGrid(origin + shift, Vec3::Unit((axis + 1) % 3), Vec3::Unit((axis + 2) % 3),
                 sameTessellation ? 4 : 2 + side);
  }
  return soup;
}

TEST(FeatureEdges, CubeHasTwelveCurvesAndEightCorners) {
  for (int n : {1, 5}) {
    const FeatureGraph graph = detect(cube(n));
    expectConsistent(graph);
    EXPECT_EQ(graph.curves().size(), 12u);
    EXPECT_EQ(graph.corners().size(), 8u);
    EXPECT_EQ(graph.segments().size(), 12u * n);
    EXPECT_NEAR(totalLength(graph), 12, 1e-12);
    EXPECT_EQ(closedCurves(graph), 0);
    for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind, kSharpEdge);
  }
}

TEST(FeatureEdges, SizeAndPlaceDoNotMatter) {
  for (const auto& [scale, offset] :
       {std::pair{1e-30, Vec3(0, 0, 0)}, {1e30, Vec3(0, 0, 0)}, {10.0, Vec3(5.5e5, 4.75e6, 100)}}) {
    const FeatureGraph graph =
        detect(cube(3).mapped([&, s = scale, o = offset](const Vec3& p) { return Vec3(s * p + o); }));
    expectConsistent(graph);
    EXPECT_EQ(graph.curves().size(), 12u);
    EXPECT_EQ(graph.corners().size(), 8u);
  }
}

TEST(FeatureEdges, OrientationDoesNotMatter) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    expectEqual(detect(cube(4)), detect(cube(4).flipped(seed)));
    const FeatureGraph graph = detect(testing::cylinder(40).flipped(seed));
    EXPECT_EQ(closedCurves(graph), 2);
    EXPECT_EQ(graph.curves().size(), 2u);
  }
}

TEST(FeatureEdges, CylinderHasTwoClosedCurves) {
  const FeatureGraph graph = detect(testing::cylinder(48));
  expectConsistent(graph);
  EXPECT_EQ(graph.curves().size(), 2u);
  EXPECT_EQ(closedCurves(graph), 2);
  EXPECT_TRUE(graph.corners().empty());
  EXPECT_EQ(graph.segments().size(), 96u);
  EXPECT_NEAR(graph.curves()[0].length(), 96 * std::sin(3.14159265358979 / 48), 1e-12);
}

TEST(FeatureEdges, SharpAngleDecides) {
  // A ridge that bends by exactly the given angle.
  for (double bend : {5.0, 29.0, 31.0, 90.0, 150.0, 179.0}) {
    const double a = bend * 3.14159265358979323846 / 180;
    Soup soup;
    soup.add({0, 0, 0}, {1, 0, 0}, {0.3, -1, 0});
    soup.add({0, 0, 0}, {1, 0, 0}, {0.6, std::cos(a), std::sin(a)});
    FeatureOptions options;
    for (double sharp : {bend - 0.01, bend + 0.01}) {
      options.sharpAngle = sharp;
      EXPECT_EQ(detect(soup, options).segments().size(), sharp < bend ? 1u : 0u) << bend;
      EXPECT_EQ(detect(soup.flipped(1), options).segments().size(), sharp < bend ? 1u : 0u) << bend;
    }
  }
}

TEST(FeatureEdges, CrumpledSheetEqualsTheDefinition) {
  // Every inner edge against the textbook angle between consistently oriented normals.
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 30);
  soup = soup.mapped([](const Vec3& p) {
    return Vec3(p[0], p[1], 0.02 * std::sin(300 * p[0] * p[0] + 170 * p[1]) + 0.01 * std::cos(90 * p[1]));
  });
  const auto model = soup.model();
  std::map<std::pair<Id, Id>, std::vector<Id>> edges;
  for (Id t = 0; t < model->triangleCount(); ++t)
    for (int k = 0; k < 3; ++k)
      edges[std::minmax(model->triangles()[t][k], model->triangles()[t][(k + 1) % 3])].push_back(t);
  std::set<std::pair<std::array<double, 3>, std::array<double, 3>>> expected;
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p[0], p[1], p[2]}; };
  for (const auto& [edge, around] : edges) {
    if (around.size() != 2) continue;
    const double cosine = model->normal(around[0]).dot(model->normal(around[1]));
    if (std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / 3.14159265358979 > 30)
      expected.insert(std::minmax(key(model->points()[edge.first]), key(model->points()[edge.second])));
  }
  ASSERT_GT(expected.size(), 200u);
  const FeatureGraph graph = detect(soup.flipped(4));
  expectConsistent(graph);
  decltype(expected) found;
  for (const FeatureSegment& s : graph.segments()) found.insert(std::minmax(key(s.a), key(s.b)));
  EXPECT_EQ(found, expected);
}

TEST(FeatureEdges, OverlappingSheetsAreSmooth) {
  // The same plate twice, with other diagonals: inner edges have three or four triangles in one plane.
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4);
  soup.addGrid({0, 1, 0}, {1, 0, 0}, {0, -1, 0}, 4);
  const FeatureGraph graph = detect(soup.flipped(1));
  // Only the rim, where both layers end.
  EXPECT_EQ(graph.segments().size(), 16u);
  EXPECT_EQ(graph.curves().size(), 4u);
  for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind, kSharpEdge);
}

TEST(FeatureEdges, JunctionOfPlatesIsNonManifoldAndSharp) {
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1);
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, -1, 0}, 1);
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 1);
  const FeatureGraph graph = detect(soup.flipped(2));
  ASSERT_EQ(graph.segments().size(), 1u);
  EXPECT_EQ(graph.segments()[0].kind, kSharpEdge | kNonManifoldEdge);
}

TEST(FeatureEdges, SliversAreNoFeatures) {
  // A plate whose middle line is closed by slivers that rounding has lifted out of the plane by steep angles.
  Soup soup;
  for (int i = 0; i < 20; ++i) {
    const Vec3 a(i, 0, 0), b(i + 1, 0, 0), c(i + 0.5, 1e-7, i % 2 ? 2e-7 : -2e-7);
    soup.add(a, b, {i + 0.5, -10, 0});
    soup.add(a, b, c);
    soup.add(a, c, {i + 0.5, 10, 0});
    soup.add(c, b, {i + 0.5, 10, 0});
  }
  EXPECT_TRUE(detect(soup).segments().empty());
}

TEST(FeatureEdges, SliverOnASharpEdgeLeavesOneCurve) {
  // A right angle, with slivers along the edge that face anywhere.
  Soup soup;
  for (int i = 0; i < 20; ++i) {
    const Vec3 a(i, 0, 0), b(i + 1, 0, 0), c(i + 0.5, i % 3 ? 1e-7 : -1e-7, 1e-7), down(i + 0.5, 0, -10);
    soup.add(a, b, down);
    soup.add(a, b, c);
    soup.add(a, c, {i + 0.5, 10, 0});
    soup.add(c, b, {i + 0.5, 10, 0});
  }
  const FeatureGraph graph = detect(soup);
  expectConsistent(graph);
  EXPECT_EQ(graph.curves().size(), 1u);
  EXPECT_NEAR(totalLength(graph), 20, 1e-4);
  EXPECT_EQ(graph.corners().size(), 2u);
}

TEST(FeatureEdges, PatchInterfaces) {
  Soup soup;
  soup.names = {"left", "right"};
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 0);
  soup.addGrid({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 1);
  FeatureOptions options;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  ASSERT_EQ(graph.curves().size(), 1u);
  EXPECT_EQ(graph.corners().size(), 2u);
  EXPECT_EQ(graph.segments().size(), 4u);
  for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind, kInterfaceEdge);
  options.interfaces = false;
  EXPECT_TRUE(detect(soup, options).segments().empty());
}

TEST(FeatureEdges, KindsAddUp) {
  const FeatureGraph graph = detect(cube(2, true));
  EXPECT_EQ(graph.curves().size(), 12u);
  for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind, kSharpEdge | kInterfaceEdge);
}

TEST(FeatureEdges, OpenEdgesOnRequest) {
  FeatureOptions options;
  EXPECT_TRUE(detect(testing::disc(60), options).segments().empty());
  options.openEdges = true;
  const FeatureGraph round = detect(testing::disc(60), options);
  expectConsistent(round);
  EXPECT_EQ(round.curves().size(), 1u);
  EXPECT_EQ(closedCurves(round), 1);
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3);
  const FeatureGraph square = detect(soup, options);
  expectConsistent(square);
  EXPECT_EQ(square.curves().size(), 4u);
  EXPECT_EQ(square.corners().size(), 4u);
  for (const FeatureSegment& s : square.segments()) EXPECT_EQ(s.kind, kOpenEdge);
}

TEST(FeatureEdges, UnstitchedCubeIsACube) {
  for (bool same : {true, false}) {
    const double gap = 1e-3;
    const Soup soup = unstitchedCube(gap, same);
    FeatureOptions options;
    options.intersections = false;
    EXPECT_TRUE(detect(soup, options).segments().empty());
    options.intersections = true;
    options.gapTolerance = 2 * gap;
    const FeatureGraph graph = detect(soup, options);
    expectConsistent(graph);
    EXPECT_EQ(graph.curves().size(), 12u);
    EXPECT_EQ(graph.corners().size(), 8u);
    EXPECT_NEAR(totalLength(graph), 12, 24 * gap);
    // Each edge of the true cube has a curve beside it, and the curves are nowhere else.
    const FeatureGraph exact = detect(cube(8));
    for (const FeatureSegment& s : exact.segments())
      EXPECT_LT(std::sqrt(graph.closest(s.a).distance2), 3 * gap);
    for (const FeatureSegment& s : graph.segments())
      EXPECT_LT(std::sqrt(exact.closest(s.a).distance2), 3 * gap);
  }
}

TEST(FeatureEdges, CrackInAPlateIsNoFeatureUnlessPatchesMeetThere) {
  Soup soup;
  soup.names = {"left", "right"};
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 0);
  soup.addGrid({1.0005, 0, 0}, {1, 0, 0}, {0, 1, 0}, 5, 0);
  FeatureOptions options;
  options.gapTolerance = 1e-3;
  EXPECT_TRUE(detect(soup, options).segments().empty());
  for (std::size_t t = 32; t < soup.patches.size(); ++t) soup.patches[t] = 1;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  EXPECT_EQ(graph.curves().size(), 1u);
  EXPECT_NEAR(totalLength(graph), 1, 2e-3);
  options.interfaces = false;
  EXPECT_TRUE(detect(soup, options).segments().empty());
}

TEST(FeatureEdges, OpenEdgeAlongASharpEdgeAddsNothing) {
  // A loose flap whose border lies along an edge of a finely tessellated cube.
  Soup soup = cube(64);
  soup.addGrid({0, 1e-3, 1.0005}, {1, 0, 0}, {0, 1, 1}, 3);
  FeatureOptions options;
  options.gapTolerance = 5e-3;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  EXPECT_NEAR(totalLength(graph), 12, 0.03);
}

TEST(FeatureEdges, LooseBorderJoinsTheCurveItEndsOn) {
  Soup soup = cube();
  soup.add({0.5, 0, 1.0005}, {0.5, -1, 2}, {0.5, 1, 2});
  FeatureOptions options;
  options.openEdges = true;
  options.gapTolerance = 1e-3;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  EXPECT_EQ(graph.curves().size(), 16u);  // one edge of the cube is two now, and three of the triangle
  EXPECT_EQ(graph.corners().size(), 11u);
  EXPECT_EQ(std::count(graph.corners().begin(), graph.corners().end(), Vec3(0.5, 0, 1)), 1);
}

TEST(FeatureEdges, RimOfABoxIsNoGap) {
  // The walls beside a rim meet it at corners, however large the tolerance: nothing is missing there.
  Soup soup = cube();
  soup.triangles.resize(10);
  soup.patches.resize(10);
  FeatureOptions options;
  options.gapTolerance = 0.2;
  const FeatureGraph graph = detect(soup, options);
  EXPECT_EQ(graph.segments().size(), 8u);
  for (const FeatureSegment& s : graph.segments()) EXPECT_EQ(s.kind, kSharpEdge);
}

TEST(FeatureEdges, WeldingStaysNearTheBorders) {
  // Tolerance far above the spacing of the points: curves must neither zigzag nor leave the tolerance.
  Soup soup = testing::disc(2000);
  soup.append(testing::disc(1777).mapped([](const Vec3& p) { return Vec3(1.0003 * p + Vec3(0, 0, 1e-3)); }));
  FeatureOptions options;
  options.openEdges = true;
  options.gapTolerance = 0.02;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  ASSERT_EQ(graph.curves().size(), 1u);
  EXPECT_TRUE(graph.curves()[0].closed);
  EXPECT_NEAR(totalLength(graph), 2 * 3.14159265, 0.03);
  for (const FeatureSegment& s : graph.segments()) EXPECT_NEAR(s.a.norm(), 1, 0.02);
}

TEST(FeatureEdges, RoundedCornersAreNoCorners) {
  // A plate with rounded corners of 24 steps each; then with steps of rounding size at its sharp corners.
  Soup soup;
  std::vector<Vec3> rim;
  for (int quarter = 0; quarter < 4; ++quarter)
    for (int i = 0; i <= 24; ++i) {
      const double a = (quarter + i / 24.0) * 3.14159265358979323846 / 2;
      const Vec3 centre(quarter == 0 || quarter == 3 ? 1 : -1, quarter < 2 ? 1 : -1, 0);
      rim.push_back(centre + 0.05 * Vec3(std::cos(a), std::sin(a), 0));
    }
  const auto fill = [&] {
    for (std::size_t i = 0; i < rim.size(); ++i) soup.add({0, 0, 0}, rim[i], rim[(i + 1) % rim.size()]);
  };
  fill();
  FeatureOptions options;
  options.openEdges = true;
  FeatureGraph graph = detect(soup, options);
  EXPECT_EQ(graph.curves().size(), 1u);
  EXPECT_EQ(closedCurves(graph), 1);

  soup = Soup();
  rim.clear();
  for (const Vec3& corner : {Vec3(1, 1, 0), Vec3(-1, 1, 0), Vec3(-1, -1, 0), Vec3(1, -1, 0)})
    for (int i = -3; i <= 3; ++i) {
      const Vec3 across(-corner[1], corner[0], 0);
      rim.push_back(corner + 1e-6 * i * across - 1e-7 * i * i * corner);
    }
  fill();
  graph = detect(soup, options);
  expectConsistent(graph);
  EXPECT_EQ(graph.curves().size(), 4u);
  EXPECT_EQ(graph.corners().size(), 4u);
}

TEST(FeatureEdges, LoopWithOneCornerStartsAndEndsThere) {
  Soup soup;
  std::vector<Vec3> rim;  // a drop: an arc of 270 degrees and a tip
  for (int i = 0; i <= 90; ++i) {
    const double a = (45 + 3.0 * i) * 3.14159265358979323846 / 180;
    rim.push_back({std::cos(a), std::sin(a), 0});
  }
  rim.push_back({std::sqrt(2.0), 0, 0});
  for (std::size_t i = 0; i < rim.size(); ++i) soup.add({0, 0, 0}, rim[i], rim[(i + 1) % rim.size()]);
  FeatureOptions options;
  options.openEdges = true;
  const FeatureGraph graph = detect(soup, options);
  expectConsistent(graph);
  ASSERT_EQ(graph.curves().size(), 1u);
  EXPECT_FALSE(graph.curves()[0].closed);
  EXPECT_EQ(graph.curves()[0].startCorner, graph.curves()[0].endCorner);
  EXPECT_EQ(graph.corners().at(0), rim.back());
}

TEST(FeatureEdges, ShortCurvesThatJoinNothingAreDropped) {
  Soup soup = cube(4);
  soup.add({5, 0, 0}, {5.1, 0, 0}, {5, 1, 0});
  soup.add({5, 0, 0}, {5.1, 0, 0}, {5, 0, 1});
  FeatureOptions options;
  EXPECT_EQ(detect(soup, options).curves().size(), 13u);
  options.shortestCurve = 0.2;
  EXPECT_EQ(detect(soup, options).curves().size(), 12u);
  options.shortestCurve = 2;  // the cube's edges are shorter, but they join
  EXPECT_EQ(detect(soup, options).curves().size(), 12u);
}

TEST(FeatureEdges, DetectionStopsOnRequest) {
  struct Stop : Monitor {
    explicit Stop(std::string in) : pass(std::move(in)) {}
    void progress(double fraction, const std::string& now) override {
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      last = fraction;
      stopped = stopped || now == pass;
    }
    bool aborted() const override { return stopped; }
    std::string pass;
    double last = 0;
    bool stopped = false;
  };
  FeatureOptions options;
  options.gapTolerance = 0.1;
  const auto model = unstitchedCube(0.01).model();
  for (const char* pass : {"sharp edges", "open edges", "self-intersections", "welding", "curves"}) {
    Stop stop(pass);
    EXPECT_THROW(detectFeatures(*model, options, &stop), AbortError) << pass;
  }
  Stop never("");
  expectEqual(detectFeatures(*model, options, &never), detectFeatures(*model, options));
}

TEST(FeatureEdges, RefusesOptionsThatMeanNothing) {
  for (double bad : {-1.0, std::nan("")}) {
    for (double FeatureOptions::*option : {&FeatureOptions::sharpAngle, &FeatureOptions::cornerAngle,
                                           &FeatureOptions::gapTolerance, &FeatureOptions::shortestCurve}) {
      FeatureOptions options;
      options.*option = bad;
      EXPECT_THROW(detect(cube(), options), InputError);
    }
  }
}

TEST(FeatureEdges, SameBitsForAnyNumberOfThreads) {
  Soup soup = unstitchedCube(1e-3);
  soup.append(testing::randomSoup(3000, 0.05, 11, 8));
  FeatureOptions options;
  options.gapTolerance = 4e-3;
  std::unique_ptr<FeatureGraph> reference;
  testing::withThreads(1, [&] { reference = std::make_unique<FeatureGraph>(detect(soup, options)); });
  EXPECT_GT(reference->curves().size(), 100u);
  expectConsistent(*reference);
  for (int threads : {2, 4})
    testing::withThreads(threads, [&] { expectEqual(detect(soup, options), *reference); });
}

}  // namespace
}  // namespace pm
