// SPDX-License-Identifier: BSD-3-Clause
// Leaks found at holes that were cut on purpose, the size that seals them, and both ways of closing them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "Clearance.h"
#include "CloseHoles.h"
#include "MeshQuality.h"
#include "PaintFront.h"
#include "Pipeline.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kCell = 0.0517;  // so that the sides of the unit cube lie within cells

/// Takes away what lies within the ball: triangles are quartered near its border first, so that the hole is
/// round.
Soup punched(const Soup& soup, const Vec3& centre, double radius) {
  Soup out;
  out.names = soup.names;
  std::vector<std::pair<std::array<Vec3, 3>, Id>> stack;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& ids = soup.triangles[t];
    stack.push_back({{soup.points[ids[0]], soup.points[ids[1]], soup.points[ids[2]]}, soup.patches[t]});
  }
  while (!stack.empty()) {
    const auto [p, patch] = stack.back();
    stack.pop_back();
    const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
    const double size = (p[0] - middle).norm() + (p[1] - middle).norm() + (p[2] - middle).norm();
    const double distance = (middle - centre).norm();
    if (std::abs(distance - radius) < size && size > 0.2 * radius) {
      const Vec3 a = 0.5 * (p[0] + p[1]), b = 0.5 * (p[1] + p[2]), c = 0.5 * (p[2] + p[0]);
      for (const std::array<Vec3, 3>& q :
           {std::array<Vec3, 3>{p[0], a, c}, {a, p[1], b}, {c, b, p[2]}, {a, b, c}})
        stack.push_back({q, patch});
    } else if (distance > radius) {
      out.add(p[0], p[1], p[2], patch);
    }
  }
  return out;
}

/// A unit cube with a round hole in the middle of the side x = 0, and perhaps another in y = 1.
Soup leakyCube(double width, double second = 0) {
  Soup soup = punched(cube(8, true), {0, 0.5, 0.5}, 0.5 * width);
  return second > 0 ? punched(soup, {0.3, 1, 0.6}, 0.5 * second) : soup;
}

OctreeDecomposeOptions cells(double size) {
  OctreeDecomposeOptions o;
  o.featureSize = o.surfaceSize = size;
  return o;
}

LeakSearch search(const SurfaceModel& model, double size = kCell, const LeakOptions& options = {}) {
  Monitor monitor;
  return findLeaks(decompose(model, cells(size), monitor), model, options, monitor);
}

double volumeInside(const SurfaceModel& model, const OctreeDecomposeOptions& octree) {
  Monitor monitor;
  const PolyMesh mesh = paintFront(decompose(model, octree, monitor), model, {}, monitor);
  return summarise(mesh, measure(mesh), {}).totalVolume;
}

/// No segment of a path goes through a triangle: each lies in the empty balls around its ends.
void expectClearOfGeometry(const Leak& leak, const SurfaceModel& model) {
  ASSERT_EQ(leak.path.size(), leak.widths.size());
  ASSERT_GE(leak.path.size(), 3u);
  for (std::size_t i = 0; i < leak.path.size(); ++i)
    EXPECT_NEAR(leak.widths[i], 2 * std::sqrt(model.closest(leak.path[i]).distance2), 1e-12);
  for (std::size_t i = 1; i < leak.path.size(); ++i) {
    const Vec3 a = leak.path[i - 1], b = leak.path[i];
    for (int k = 0; k <= 10; ++k) EXPECT_GT(model.closest(a + 0.1 * k * (b - a)).distance2, 0);
  }
}

TEST(LeakPaths, AClosedBodyHasNone) {
  const LeakSearch found = search(*cube(4, true).model());
  EXPECT_TRUE(found.leaks.empty());
  EXPECT_TRUE(found.pockets.empty());
  EXPECT_EQ(describe(found.leaks), "");
}

TEST(LeakPaths, EveryHoleIsFoundAtItsPlace) {
  const auto model = leakyCube(0.3, 0.2).model();
  const LeakSearch found = search(*model);
  ASSERT_EQ(found.pockets.size(), 1u);
  EXPECT_NEAR(found.pockets[0].volume, 1, 0.35) << "the cut leaves along the walls do not count";
  EXPECT_NEAR(found.pockets[0].peakClearance, 0.5, kCell);
  ASSERT_EQ(found.leaks.size(), 2u);
  EXPECT_NEAR(found.leaks[0].width, 0.3, 0.1 * 0.3);
  EXPECT_NEAR(found.leaks[1].width, 0.2, 0.1 * 0.2);
  EXPECT_LT((found.leaks[0].bottleneck - Vec3(0, 0.5, 0.5)).norm(), kCell);
  EXPECT_LT((found.leaks[1].bottleneck - Vec3(0.3, 1, 0.6)).norm(), kCell);
  for (const Leak& leak : found.leaks) {
    expectClearOfGeometry(leak, *model);
    const double narrowest = *std::min_element(leak.widths.begin(), leak.widths.end());
    EXPECT_LE(narrowest, leak.width + 1e-12) << "the width bounds every way through the hole";
    EXPECT_EQ(leak.path[leak.bottleneckRow], leak.bottleneck);
    const Box room = model->bounds();
    EXPECT_TRUE(room.contains(leak.path.front()));
    EXPECT_FALSE(room.contains(leak.path.back()));
    EXPECT_NEAR(leak.membrane.area, 0.25 * 3.14159 * leak.width * leak.width, 0.15 * leak.membrane.area);
  }
}

TEST(LeakPaths, TheSealingSizeSealsAndAClearlySmallerOneLeaks) {
  const auto model = leakyCube(0.3).model();
  LeakOptions options;
  options.roots = RootCells::FromFeature;
  const LeakSearch found = search(*model, kCell, options);
  ASSERT_EQ(found.leaks.size(), 1u);
  const double size = found.leaks[0].sealingSize;
  EXPECT_GT(size, found.leaks[0].width);
  EXPECT_LT(size, 1.05 * found.leaks[0].width);
  OctreeDecomposeOptions o;
  for (double factor : {1.0, 1.1, 1.2}) {
    o.featureSize = factor * size;
    Monitor monitor;
    const Octree tree = decompose(*model, o, monitor);
    PaintFrontOptions front;
    front.region = Region::Points;
    for (Id leaf = 0; leaf < tree.size() && front.points.empty(); ++leaf) {
      const Vec3 centre = tree.box(leaf).centre();
      if (!tree.cut[leaf] && model->bounds().contains(centre)) front.points.push_back(centre);
    }
    if (front.points.empty()) continue;  // no cell fits inside, so none leaks
    EXPECT_NO_THROW(paintFront(tree, *model, front, monitor)) << factor;
  }
  o = cells(size / 3);
  EXPECT_THROW(volumeInside(*model, o), RegionError);
}

TEST(LeakPaths, GivenPoints) {
  const auto model = leakyCube(0.3).model();
  LeakOptions options;
  options.insidePoints = {Vec3(0.8, 0.8, 0.8)};
  const LeakSearch found = search(*model, kCell, options);
  ASSERT_EQ(found.leaks.size(), 1u);
  EXPECT_LT((found.leaks[0].bottleneck - Vec3(0, 0.5, 0.5)).norm(), kCell);
  EXPECT_EQ(found.leaks[0].path.front(), Vec3(0.8, 0.8, 0.8));
  EXPECT_TRUE(search(*cube(4, true).model(), kCell, options).leaks.empty()) << "a closed room does not leak";
  options.insidePoints = {Vec3(0.5, 0.5, 1)};
  EXPECT_THROW(search(*model, kCell, options), RegionError) << "on the geometry";
  options.insidePoints = {Vec3(99, 0, 0)};
  EXPECT_THROW(search(*model, kCell, options), RegionError) << "outside the octree";
  options.insidePoints = options.outsidePoints = {Vec3(0.8, 0.8, 0.8)};
  EXPECT_THROW(search(*model, kCell, options), InputError) << "on both sides";
}

/// A unit cube without the side x = 0.
Soup openCube() {
  const Soup whole = cube(4, true);
  Soup soup;
  soup.names = whole.names;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    const auto& [a, b, c] = whole.triangles[t];
    if (whole.points[a][0] + whole.points[b][0] + whole.points[c][0] > 0)
      soup.add(whole.points[a], whole.points[b], whole.points[c], whole.patches[t]);
  }
  return soup;
}

TEST(LeakPaths, AnOpeningAsWideAsTheRoomNeedsAPoint) {
  const auto model = openCube().model();
  EXPECT_TRUE(search(*model).leaks.empty()) << "a recess is no room";
  LeakOptions options;
  for (const Vec3& p : {Vec3(0.5, 0.5, 0.5), Vec3(0.07, 0.5, 0.5), Vec3(0.9, 0.1, 0.9)}) {
    options.insidePoints = {p};
    const LeakSearch found = search(*model, kCell, options);
    ASSERT_EQ(found.leaks.size(), 1u);
    const Leak& leak = found.leaks[0];
    EXPECT_FALSE(leak.wide) << "the point says that it is a leak";
    EXPECT_NEAR(leak.width, 1, 0.01);
    EXPECT_NEAR(leak.membrane.area, 1, 1e-9);
    for (const Vec3& q : leak.membrane.points) EXPECT_NEAR(q[0], 0, 1e-12) << "in the opening";
    EXPECT_LT((leak.bottleneck - Vec3(0, 0.5, 0.5)).norm(), kCell);
    expectClearOfGeometry(leak, *model);
  }
}

TEST(CloseHoles, AWideOpeningIsShownAndClosedOnlyForAPoint) {
  const auto model = openCube().model();
  Monitor monitor;
  CloseHolesReport report;
  CloseHolesOptions options;
  options.method = HoleMethod::ShowOnly;
  closeHoles(*model, cells(kCell), options, monitor, &report);
  ASSERT_EQ(report.holes.size(), 1u);
  EXPECT_TRUE(report.holes[0].leak.wide);
  EXPECT_TRUE(report.tight) << "it may be meant to be there";
  for (HoleMethod method : {HoleMethod::CoarseToFine, HoleMethod::Offset}) {
    options = {};
    options.method = method;
    EXPECT_EQ(closeHoles(*model, cells(kCell), options, monitor, &report)->triangleCount(),
              model->triangleCount());
    options.search.insidePoints = {Vec3(0.6, 0.4, 0.5)};
    const auto closed = closeHoles(*model, cells(kCell), options, monitor, &report);
    ASSERT_EQ(report.holes.size(), 1u);
    EXPECT_TRUE(report.holes[0].closed && report.tight);
    EXPECT_NEAR(volumeInside(*closed, cells(kCell)), volumeInside(*cube(4, true).model(), cells(kCell)),
                0.08);
  }
}

TEST(LeakPaths, SameForAnyNumberOfThreads) {
  const auto model = leakyCube(0.3, 0.2).model();
  LeakSearch one, four;
  withThreads(1, [&] { one = search(*model); });
  withThreads(4, [&] { four = search(*model); });
  ASSERT_EQ(one.leaks.size(), four.leaks.size());
  EXPECT_EQ(one.sides, four.sides);
  for (std::size_t i = 0; i < one.leaks.size(); ++i) {
    EXPECT_EQ(one.leaks[i].path, four.leaks[i].path);
    EXPECT_EQ(one.leaks[i].widths, four.leaks[i].widths);
    EXPECT_EQ(one.leaks[i].membrane.points, four.leaks[i].membrane.points);
  }
}

class ClosingMethods : public ::testing::TestWithParam<HoleMethod> {};

TEST_P(ClosingMethods, TheClosedBodyHasTheVolumeOfTheWholeOne) {
  const OctreeDecomposeOptions octree = cells(kCell);
  const double whole = volumeInside(*cube(8, true).model(), octree);
  for (double width : {0.5 * kCell, kCell, 2 * kCell, 3 * kCell, 6 * kCell}) {
    const auto model = leakyCube(width, 0.8 * width).model();
    CloseHolesOptions options;
    options.method = GetParam();
    Monitor monitor;
    CloseHolesReport report;
    const auto closed = closeHoles(*model, octree, options, monitor, &report);
    EXPECT_TRUE(report.tight) << width;
    EXPECT_NEAR(volumeInside(*closed, octree), whole, 0.03 * whole) << width;
    if (width < 3 * kCell) continue;  // whether smaller ones leak depends on where the cells lie
    ASSERT_GE(report.holes.size(), 1u) << width;
    EXPECT_TRUE(report.holes[0].closed);
    EXPECT_EQ(closed->patchNames().back(), kClosedHolesPatch);
    EXPECT_EQ(closed->triangleCount() - model->triangleCount() <= report.addedTriangles, true);
    for (Id t = 0; t < model->triangleCount(); ++t) {
      ASSERT_EQ(closed->corner(t, 0), model->corner(t, 0)) << "the geometry itself is kept";
      ASSERT_EQ(closed->patchOf(t), model->patchOf(t));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CloseHoles, ClosingMethods,
                         ::testing::Values(HoleMethod::CoarseToFine, HoleMethod::Offset));

TEST(CloseHoles, AnOffsetCapIsSmoothAndLiesSnugly) {
  const auto model = leakyCube(6 * kCell).model();
  CloseHolesOptions options;
  options.method = HoleMethod::Offset;
  Monitor monitor;
  CloseHolesReport report;
  const auto closed = closeHoles(*model, cells(kCell), options, monitor, &report);
  ASSERT_EQ(report.holes.size(), 1u) << "the cap seals at once";
  for (Id t = model->triangleCount(); t < closed->triangleCount(); ++t)
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(closed->corner(t, k).x(), 0, 0.2 * kCell);
}

TEST(CloseHoles, AnOffsetCapFollowsRoundGeometry) {
  const Soup ball =
      cube(12).mapped([](const Vec3& p) { return Vec3((p - Vec3::Constant(0.5)).normalized()); });
  constexpr double cell = 0.1, radius = 2.5 * cell;
  for (const Vec3& pole : {Vec3(1, 0, 0), Vec3(-0.48, 0.6, 0.64), Vec3(0.6, -0.64, -0.48)}) {
    const auto model = punched(ball, pole, radius).model();
    CloseHolesOptions options;
    options.method = HoleMethod::Offset;
    Monitor monitor;
    CloseHolesReport report;
    const auto closed = closeHoles(*model, cells(cell), options, monitor, &report);
    EXPECT_TRUE(report.tight);
    for (Id t = model->triangleCount(); t < closed->triangleCount(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = closed->corner(t, k);
        if ((p - pole).norm() < radius + 0.5 * cell) continue;  // over the hole
        ASSERT_NEAR(p.norm(), 1, 0.25 * cell) << "the coarse wall dips by more than a cell here";
      }
  }
}

TEST(CloseHoles, OffsetLooksOnlyAtWhatIsNearTheRoom) {
  Soup soup = leakyCube(6 * kCell);
  soup.append(cube(1, true).mapped([](const Vec3& p) { return Vec3(5000 * p + Vec3(2, 0, 0)); }));
  OctreeDecomposeOptions octree = cells(kCell);
  octree.useDomain = true;
  octree.domain = Box{Vec3::Constant(-0.5), Vec3::Constant(1.5)};
  CloseHolesOptions options;
  options.method = HoleMethod::Offset;
  options.search.insidePoints = {Vec3(0.6, 0.4, 0.5)};
  Monitor monitor;
  CloseHolesReport report;
  closeHoles(*soup.model(), octree, options, monitor, &report);
  ASSERT_FALSE(report.holes.empty());
  EXPECT_TRUE(report.tight);
}

TEST(CloseHoles, WideHolesStayOpenOnRequest) {
  const auto model = leakyCube(0.4, 0.2).model();
  CloseHolesOptions options;
  options.maximumWidth = 0.3;
  Monitor monitor;
  CloseHolesReport report;
  const auto closed = closeHoles(*model, cells(kCell), options, monitor, &report);
  ASSERT_EQ(report.holes.size(), 2u);
  EXPECT_FALSE(report.holes[0].closed);
  EXPECT_TRUE(report.holes[1].closed);
  EXPECT_TRUE(report.tight) << "what was asked for is done";
  const LeakSearch left = search(*closed);
  ASSERT_EQ(left.leaks.size(), 1u);
  EXPECT_NEAR(left.leaks[0].width, 0.4, 0.04);
}

TEST(CloseHoles, ShowOnlyChangesNothing) {
  const auto model = leakyCube(0.3).model();
  CloseHolesOptions options;
  options.method = HoleMethod::ShowOnly;
  Monitor monitor;
  CloseHolesReport report;
  const auto same = closeHoles(*model, cells(kCell), options, monitor, &report);
  EXPECT_EQ(same->contentHash(), model->contentHash());
  ASSERT_EQ(report.holes.size(), 1u);
  EXPECT_FALSE(report.holes[0].closed);
  EXPECT_FALSE(report.tight);
}

TEST(CloseHoles, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } monitor;
  EXPECT_THROW(closeHoles(*leakyCube(0.3).model(), cells(kCell), {}, monitor), AbortError);
}

TEST(LeakError, PaintFrontShowsTheLeak) {
  const auto model = leakyCube(0.3).model();
  Monitor monitor;
  const Octree tree = decompose(*model, cells(kCell), monitor);
  PaintFrontOptions front;
  for (Region region : {Region::Inside, Region::Points}) {
    front.region = region;
    front.points = {Vec3(0.7, 0.6, 0.5)};
    try {
      paintFront(tree, *model, front, monitor);
      FAIL() << "it leaks";
    } catch (const LeakError& error) {
      ASSERT_EQ(error.leaks.size(), 1u);
      EXPECT_LT((error.leaks[0].bottleneck - Vec3(0, 0.5, 0.5)).norm(), kCell);
      const std::string sentence = error.what();
      EXPECT_NE(sentence.find(describe(error.leaks)), std::string::npos) << sentence;
      EXPECT_NE(sentence.find("a feature size of"), std::string::npos) << sentence;
    }
  }
}

TEST(LeakError, ASmallCavityIsNotTakenForALeakingRoomWithoutAWord) {
  struct Listener : Monitor {
    std::vector<std::string> said;
    void warning(const std::string& sentence) override { said.push_back(sentence); }
  } listener;
  Soup soup = leakyCube(0.3);
  soup.append(cube(1, true).mapped([](const Vec3& p) { return Vec3(0.35 * p + Vec3(1.3, 0, 0)); }));
  const auto model = soup.model();
  paintFront(decompose(*model, cells(kCell), listener), *model, {}, listener);
  ASSERT_EQ(listener.said.size(), 1u);
  EXPECT_NE(listener.said[0].find("leaks"), std::string::npos);
}

TEST(Pipeline, ClosesHolesFirst) {
  PipelineOptions options;
  options.octree = cells(kCell);
  options.stopAfter = Stage::Projected;
  Monitor monitor;
  EXPECT_THROW(runPipeline(*leakyCube(0.3).model(), options, monitor), LeakError);
  options.closeHoles = HoleMethod::CoarseToFine;
  PipelineReport report;
  const PolyMesh mesh = runPipeline(*leakyCube(0.3).model(), options, monitor, &report);
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_NEAR(summarise(mesh, measure(mesh), {}).totalVolume, 1, 0.02);
  ASSERT_EQ(report.holes.holes.size(), 1u);
  double area = 0;
  const MeshMeasures m = measure(mesh);
  for (Id b = 0; b < mesh.boundaryFaces(); ++b)
    if (mesh.patchNames[mesh.patch[b]] == kClosedHolesPatch)
      area += m.faces[mesh.internalFaces() + b].normal.norm();
  EXPECT_NEAR(area, 3.14159 * 0.15 * 0.15, 0.03);
}

TEST(Membrane, QuarteringKeepsAreaAndSharedEdges) {
  std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<std::array<Id, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  quarter(points, triangles);
  EXPECT_EQ(triangles.size(), 8u);
  EXPECT_EQ(points.size(), 9u) << "the middle of the shared edge is one point";
  double area = 0;
  for (const auto& t : triangles)
    area += 0.5 * (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]])[2];
  EXPECT_DOUBLE_EQ(area, 1);
}

TEST(Watershed, ClearanceIsTheDistanceOfTheCentre) {
  const auto model = cube(2, true).model();
  Monitor monitor;
  const Octree tree = decompose(*model, cells(0.1), monitor);
  const std::vector<double> clearance = leafClearance(tree, *model, monitor);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (tree.cut[leaf]) {
      EXPECT_LT(clearance[leaf], 0);
      continue;
    }
    const Vec3 c = tree.box(leaf).centre();
    EXPECT_DOUBLE_EQ(clearance[leaf], std::sqrt(model->closest(c).distance2));
    EXPECT_GE(clearance[leaf], 0.5 * tree.brick.edge(tree.levels[leaf]) - 1e-12);
  }
}

}  // namespace
