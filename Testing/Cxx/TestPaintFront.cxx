// SPDX-License-Identifier: BSD-3-Clause
// Painting, the permitted patterns, and the front as a mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "FrontPredicates.h"
#include "LeakPaths.h"
#include "MeshQuality.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "TestRooms.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

PolyMesh paint(const SurfaceModel& model, double size, const PaintFrontOptions& front = {},
               const OctreeDecomposeOptions& start = {}, PaintFrontReport* report = nullptr) {
  OctreeDecomposeOptions o = start;
  o.featureSize = size;
  Monitor monitor;
  return paintFront(decompose(model, o, monitor), model, front, monitor, report);
}

/// Smallest pattern among all rotations and reflections: names the class.
unsigned patternClass(unsigned pattern) {
  unsigned smallest = 255;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (unsigned flip = 0; flip < 8; ++flip) {
      unsigned turned = 0;
      for (unsigned k = 0; k < 8; ++k) {
        if (!(pattern >> k & 1)) continue;
        unsigned m = 0;
        for (int a = 0; a < 3; ++a) m |= ((k >> axes[a] & 1) ^ (flip >> a & 1)) << a;
        turned |= 1u << m;
      }
      smallest = std::min(smallest, turned);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return smallest;
}

TEST(FrontPatterns, OneHundredAndTwoInEightClasses) {
  int permitted = 0;
  std::set<unsigned> classes;
  for (unsigned p = 0; p < 256; ++p)
    if (isPermittedPattern(p)) {
      ++permitted;
      classes.insert(patternClass(p));
    }
  EXPECT_EQ(permitted, 102);
  EXPECT_EQ(classes.size(), 8u);
  EXPECT_TRUE(isPermittedPattern(0x01));
  EXPECT_TRUE(isPermittedPattern(0x0f));
  EXPECT_FALSE(isPermittedPattern(0x81)) << "cells that share a corner only";
  EXPECT_FALSE(isPermittedPattern(0x09)) << "cells that share an edge only";
  EXPECT_FALSE(isPermittedPattern(0x00));
  EXPECT_FALSE(isPermittedPattern(0xff));
}

TEST(FrontPatterns, ClosedUnderRotationAndReflection) {
  for (unsigned p = 1; p < 255; ++p) {
    const unsigned c = patternClass(p);
    EXPECT_EQ(isPermittedPattern(p), isPermittedPattern(c));
  }
}

void expectSound(const PolyMesh& mesh) {
  EXPECT_EQ(checkTopology(mesh), "");
  const QualitySummary q = summarise(mesh, measure(mesh), {});
  EXPECT_GT(q.minTet, 0);
  EXPECT_LT(q.maxOpenness, 1e-12);
  EXPECT_EQ(mesh.stage, Stage::Front);
}

TEST(PaintFront, InsideOfACubeHasItsVolumeLessTheRim) {
  const auto model = cube(1, true).model();
  PaintFrontReport report;
  const PolyMesh mesh = paint(*model, 0.06, {}, {}, &report);
  expectSound(mesh);
  ASSERT_EQ(report.regions.size(), 2u);
  EXPECT_TRUE(report.regions[0].open);
  EXPECT_FALSE(report.regions[1].open);
  const double volume = summarise(mesh, measure(mesh), {}).totalVolume;
  EXPECT_GT(volume, std::pow(1 - 5 * 0.06, 3));
  EXPECT_LT(volume, 1);
  // Every side of the cube is a patch with faces.
  for (Id patch = 0; patch < 6; ++patch)
    EXPECT_GT(std::count(mesh.patch.begin(), mesh.patch.end(), patch), 0) << mesh.patchNames[patch];
}

TEST(PaintFront, FlippedTrianglesChangeNothing) {
  const Soup soup = cylinder(40);
  const PolyMesh a = paint(*soup.model(), 0.1), b = paint(*soup.flipped(5).model(), 0.1);
  EXPECT_EQ(checksum(a), checksum(b));
}

TEST(PaintFront, OutsideReachesTheSidesOfTheDomain) {
  const auto model = cube().model();
  OctreeDecomposeOptions o;
  o.useDomain = true;
  o.domain.add(Vec3(-1, -1, -1));
  o.domain.add(Vec3(2, 2, 2));
  PaintFrontOptions front;
  front.region = Region::Outside;
  const PolyMesh mesh = paint(*model, 0.1, front, o);
  expectSound(mesh);
  ASSERT_EQ(mesh.patchNames.size(), 7u);
  EXPECT_EQ(mesh.patchNames[1], "xmin");
  EXPECT_EQ(mesh.patchTypes[1], "patch");
  const MeshMeasures m = measure(mesh);
  for (Id side = 1; side < 7; ++side) {
    double area = 0;
    for (Id b = 0; b < mesh.boundaryFaces(); ++b)
      if (mesh.patch[b] == side) area += m.faces[mesh.internalFaces() + b].normal.norm();
    EXPECT_NEAR(area, 9, 1e-9) << mesh.patchNames[side];
  }
}

TEST(PaintFront, DisjointCubesAreRegionsOfTheirOwn) {
  Soup two = cube();
  two.append(cube().mapped([](const Vec3& p) { return Vec3(0.5 * p + Vec3(2, 0, 0)); }));
  const auto model = two.model();
  PaintFrontOptions front;
  front.region = Region::Points;
  front.points = {Vec3(2.25, 0.25, 0.25)};
  const PolyMesh small = paint(*model, 0.05, front);
  front.points.push_back(Vec3(0.5, 0.5, 0.5));
  const PolyMesh both = paint(*model, 0.05, front);
  const PolyMesh large = paint(*model, 0.05);
  expectSound(both);
  EXPECT_EQ(small.cellCount + large.cellCount, both.cellCount);
  const auto volume = [](const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; };
  EXPECT_GT(volume(large), volume(small));
}

TEST(PaintFront, LeaksAndBadPointsAreNamed) {
  Soup open = cube();
  open.triangles.pop_back();
  open.triangles.pop_back();
  open.patches.resize(open.triangles.size());
  const auto model = open.model();
  EXPECT_THROW(paint(*model, 0.05), RegionError) << "a cube without a side encloses nothing";
  PaintFrontOptions front;
  front.region = Region::Points;
  front.points = {Vec3(0.5, 0.5, 0.5)};
  EXPECT_THROW(paint(*model, 0.05, front), RegionError) << "the region leaks";
  front.points = {Vec3(100, 0, 0)};
  EXPECT_THROW(paint(*model, 0.05, front), RegionError) << "the point is outside the domain";
  front.points = {Vec3(0.5, 0.5, 0)};
  EXPECT_THROW(paint(*model, 0.05, front), RegionError) << "the point is on the geometry";
  front.points.clear();
  EXPECT_THROW(paint(*model, 0.05, front), InputError);
}

// A box without its top, too wide open to be called a room that leaks, and a small closed box beside its
// wall.
TEST(PaintFront, TinyRegionIsNotTakenWithoutAWord) {
  struct Listener : Monitor {
    void warning(const std::string& sentence) override { heard += sentence; }
    std::string heard;
  };
  const auto warnings = [](const Soup& soup) {
    const auto model = soup.model();
    OctreeDecomposeOptions octree;
    octree.featureSize = 0.02;
    Listener listener;
    paintFront(decompose(*model, octree, listener), *model, {}, listener);
    return listener.heard;
  };
  Soup box = cube();
  EXPECT_EQ(warnings(box), "");
  box.triangles.resize(box.triangles.size() - 2);
  box.patches.resize(box.triangles.size());
  box.append(cube().mapped(
      [](const Vec3& p) { return Vec3(0.1 + 0.1 * p[0], 0.1 + 0.1 * p[1], 0.1 + 0.1 * p[2]); }));
  EXPECT_NE(warnings(box).find("% of the box around the geometry"), std::string::npos) << warnings(box);
}

TEST(PaintFront, OtherEnclosedRegionsAreNoted) {
  const auto notes = [](const Soup& soup, Region region) {
    PaintFrontOptions front;
    front.region = region;
    PaintFrontReport report;
    paint(*soup.model(), 0.05, front, {}, &report);
    return report.notes;
  };
  Soup two = cube(3);
  EXPECT_TRUE(notes(two, Region::Inside).empty());
  two.append(cube(3).mapped([](const Vec3& p) { return Vec3(p[0] + 1.5, p[1], p[2]); }));
  ASSERT_EQ(notes(two, Region::Inside).size(), 1u);
  EXPECT_NE(notes(two, Region::Inside)[0].find("% is in the mesh; another region is not"), std::string::npos)
      << notes(two, Region::Inside)[0];
  EXPECT_TRUE(notes(two, Region::Enclosed).empty());
}

// A wall of 1 by 1 by 0.02 holds no cell of 0.05; it is the user's to know that no hole is to be looked for.
TEST(PaintFront, NothingEnclosedSaysWhetherTheGeometryIsClosed) {
  const auto sentence = [](const Soup& soup) -> std::string {
    try {
      paint(*soup.model(), 0.05);
    } catch (const RegionError& error) {
      return error.what();
    }
    return "";
  };
  Soup plate = cube(3).mapped([](const Vec3& p) { return Vec3(p[0], p[1], 0.02 * p[2]); });
  EXPECT_NE(sentence(plate).find("it is closed, but too thin"), std::string::npos) << sentence(plate);
  plate.triangles.pop_back();
  plate.patches.pop_back();
  EXPECT_NE(sentence(plate).find("3 of its edges lie on one"), std::string::npos) << sentence(plate);
  Soup box = cube();
  box.triangles.resize(box.triangles.size() - 2);
  box.patches.resize(box.triangles.size());
  EXPECT_NE(sentence(box).find("4 of its edges lie on one"), std::string::npos) << sentence(box);
}

// Two rooms of 1 by 1 by 1 with a duct of 0.2 by 0.2 between them, about (1.25, 0.5, 0.5).
TEST(PaintFront, RegionThatHoldsAKeepOutPointLeaks) {
  const auto duct = [](const Vec3& c) {
    const bool between = c[0] > 1 && c[0] < 1.5;
    return between && ((c - Vec3(1.25, 0.5, 0.5)).cwiseAbs().array() > Vec3(0.3, 0.1, 0.1).array()).any() ? 0
                                                                                                          : 1;
  };
  const auto model =
      rooms({std::vector<double>{0, 1, 1.5, 2.5}, {0, 0.4, 0.6, 1}, {0, 0.4, 0.6, 1}}, 1, duct).model();
  PaintFrontOptions front;
  front.keepOut = {Vec3(2.2, 0.5, 0.5)};
  for (const bool seeded : {false, true}) {
    if (seeded) {
      front.region = Region::Points;
      front.points = {Vec3(0.3, 0.5, 0.5)};
    }
    try {
      paint(*model, 0.05, front);
      FAIL() << "no leak";
    } catch (const LeakError& leak) {
      ASSERT_EQ(leak.leaks.size(), 1u);
      EXPECT_LT((leak.leaks[0].bottleneck - Vec3(1.25, 0.5, 0.5))
                    .cwiseAbs()
                    .cwiseQuotient(Vec3(0.3, 0.1, 0.1))
                    .maxCoeff(),
                1);
      EXPECT_NEAR(leak.leaks[0].width, 0.2, 0.02);
      EXPECT_NE(std::string(leak.what()).find("kept out"), std::string::npos);
    }
  }
  front.keepOut = {Vec3(1.25, 0.9, 0.9)};  // in the wall, which nothing reaches
  PaintFrontReport report;
  EXPECT_GT(paint(*model, 0.05, front, {}, &report).cellCount, 1000);
  EXPECT_EQ(std::count(report.painted.begin(), report.painted.end(), 1), report.chosenCells);
}

TEST(PaintFront, RandomSoupsGiveSoundFronts) {
  OctreeDecomposeOptions o;
  o.useDomain = true;
  o.domain.add(Vec3(-0.5, -0.5, -0.5));
  o.domain.add(Vec3(1.5, 1.5, 1.5));
  o.baseSize = 0.5;
  PaintFrontOptions front;
  front.region = Region::Outside;
  for (unsigned seed = 0; seed < 8; ++seed)
    expectSound(paint(*randomSoup(60, 0.3, seed).model(), 0.0625, front, o));
}

/// Eight leaves of one level, `pattern` of them painted, inside a ring of unpainted ones.
bool holds(unsigned pattern, bool (*predicate)(const Octree&, const std::vector<std::uint8_t>&)) {
  Octree tree;
  tree.brick.roots = {4, 4, 4};
  for (Key key = 0; key < 64; ++key) tree.keys.push_back(key);
  tree.levels.assign(64, 0);
  tree.cut.assign(64, 0);
  tree.index();
  std::vector<std::uint8_t> painted(64, 0);
  for (int k = 0; k < 8; ++k)
    painted[tree.find({1 + (k & 1), 1 + (k >> 1 & 1), 1 + (k >> 2)})] = pattern >> k & 1;
  return predicate(tree, painted);
}

/// Centre of the leaf that each cell of a front's mesh is.
std::vector<Vec3> leafCentres(const PolyMesh& mesh) {
  std::vector<Box> boxes(mesh.cellCount);
  for (Id f = 0; f < mesh.faces.rows(); ++f)
    for (Id p : mesh.faces[f]) {
      boxes[mesh.owner[f]].add(mesh.points[p]);
      if (f < mesh.internalFaces()) boxes[mesh.neighbour[f]].add(mesh.points[p]);
    }
  std::vector<Vec3> centres;
  for (const Box& box : boxes) centres.push_back(box.centre());
  return centres;
}

// Filling and growing take cells that the geometry cuts: never such that the domain goes through a wall.
TEST(PaintFront, NoWayLeadsThroughASheet) {
  std::mt19937_64 g(7);
  for (int seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Soup soup;
    for (int sheet = 0; sheet < 3; ++sheet) {
      const Vec3 u = randomPoint(g, -0.5, 0.5), v = randomPoint(g, -0.5, 0.5);
      soup.addGrid(randomPoint(g, 0.2, 0.8) - 0.5 * (u + v), u, v, 4);
    }
    const auto model = soup.model();
    PaintFrontOptions options;
    options.region = Region::Everything;
    const PolyMesh mesh = paint(*model, 0.06, options);
    expectSound(mesh);
    const std::vector<Vec3> centres = leafCentres(mesh);
    for (Id f = 0; f < mesh.internalFaces(); ++f)
      EXPECT_FALSE(model->crosses(centres[mesh.owner[f]], centres[mesh.neighbour[f]]));
  }
}

TEST(FrontPredicates, KnowGoodAndBadFronts) {
  for (unsigned good : {0x00u, 0x01u, 0x03u, 0x0fu, 0x17u, 0x7fu, 0xffu}) {
    EXPECT_TRUE(holds(good, frontIsManifold)) << good;
    EXPECT_TRUE(holds(good, frontIsPermitted)) << good;
  }
  for (unsigned bad : {0x09u, 0x81u, 0x7eu, 0xe7u}) {
    EXPECT_FALSE(holds(bad, frontIsManifold)) << bad;
    EXPECT_FALSE(holds(bad, frontIsPermitted)) << bad;
  }
  EXPECT_TRUE(holds(0x27, frontIsManifold)) << "a twisted chain of four is one sheet,";
  EXPECT_FALSE(holds(0x27, frontIsPermitted)) << "but faces both ways (Fig. 3-30)";
}

TEST(FrontPredicates, PermittedIsManifoldWithoutOppositeFaces) {
  int manifold = 0, permitted = 0;
  for (unsigned p = 1; p < 255; ++p) {
    manifold += isManifoldPattern(p);
    permitted += isPermittedPattern(p);
    EXPECT_TRUE(isManifoldPattern(p) || !isPermittedPattern(p)) << p;
  }
  EXPECT_EQ(permitted, 102);
  EXPECT_EQ(manifold, 126);
}

}  // namespace
