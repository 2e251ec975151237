// SPDX-License-Identifier: BSD-3-Clause
// Each refinement criterion alone: on, it makes small cells where its shape asks and says so; off, it does
// not.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "OctreeDecompose.h"
#include "RefineReason.h"
#include "TestOctrees.h"

namespace {

using namespace pm;
using namespace pm::testing;

RefineReason reasonAt(const Octree& tree, const Vec3& p) {
  return static_cast<RefineReason>(tree.refinedBy[tree.locate(p)]);
}

bool anyBy(const Octree& tree, RefineReason reason) {
  return std::count(tree.refinedBy.begin(), tree.refinedBy.end(), static_cast<std::uint8_t>(reason)) > 0;
}

/// Unrefined: nothing but root cells.
bool onlyRoots(const Octree& tree) {
  return std::all_of(tree.levels.begin(), tree.levels.end(), [](int level) { return level == 0; });
}

/// A floor and a wall that meet at a right angle in the line x = 1, z = 0.
Soup fold() {
  Soup s;
  s.addGrid(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 1);
  s.addGrid(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), 1);
  return s;
}

Soup plates(double gap, const Vec3& normal = Vec3::UnitZ()) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
  Soup s;
  for (double z : {0.0, gap}) s.addGrid(Vec3(0, 0, z), Vec3(1, 0, 0), Vec3(0, 1, 0), 1);
  return s.mapped([&](const Vec3& p) { return Vec3(turn * p); });
}

Soup sphere(double radius, const Vec3& centre, int n = 24) {
  return cube(n).mapped(
      [&](const Vec3& p) { return Vec3(centre + radius * (2 * p - Vec3::Ones()).normalized()); });
}

TEST(RefinementCriteria, NormalsWithinACell) {
  const auto model = fold().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.normalAngle = 40;
  o.neighbourNormals = false;
  const Vec3 onFold(1 - 1e-3, 0.51, 1e-3);
  const Octree on = run(*model, o);
  EXPECT_TRUE(finestAt(on, onFold));
  EXPECT_EQ(reasonAt(on, onFold), RefineReason::CellNormals);
  o.cellNormals = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, NormalsOfAdjacentCells) {
  const auto model = fold().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.normalAngle = 40;
  o.cellNormals = false;
  const Octree on = run(*model, o);
  EXPECT_TRUE(finestAt(on, Vec3(1 - 1e-3, 0.51, 1e-3)));
  EXPECT_TRUE(anyBy(on, RefineReason::Normals));
  EXPECT_FALSE(anyBy(on, RefineReason::CellNormals));
  o.neighbourNormals = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, FacingSurfacesWithinACell) {
  const auto model = plates(0.1).model();  // both in the middle one of five layers of root cells of 0.16
  OctreeDecomposeOptions o = bare(0.02);
  o.separate = true;
  o.neighbourSeparation = false;
  const Octree on = run(*model, o);
  EXPECT_TRUE(anyBy(on, RefineReason::CellFacing));
  EXPECT_FALSE(anyBy(on, RefineReason::Facing));
  o.cellSeparation = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, FacingSurfacesOfAdjacentCells) {
  const auto model = plates(0.1).model();
  OctreeDecomposeOptions o = bare(0.02);
  o.separate = true;
  o.cellSeparation = false;
  o.margin = 1.5;  // four layers of root cells: one plate to either side of their middle
  const Octree on = run(*model, o);
  EXPECT_TRUE(anyBy(on, RefineReason::Facing));
  EXPECT_FALSE(anyBy(on, RefineReason::CellFacing));
  o.neighbourSeparation = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, SharpEdgesAndCorners) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  const Vec3 onEdge(0.51, 1e-3, 1e-3), atCorner(1e-3, 1e-3, 1e-3), onSide(0.51, 0.51, 1e-3);
  const Octree all = run(*model, o);
  EXPECT_TRUE(finestAt(all, onEdge) && finestAt(all, atCorner));
  EXPECT_FALSE(finestAt(all, onSide));
  EXPECT_EQ(reasonAt(all, onEdge), RefineReason::Feature);
  o.refineSharp = false;
  const Octree corners = run(*model, o);
  EXPECT_TRUE(finestAt(corners, atCorner));
  EXPECT_FALSE(finestAt(corners, onEdge));
  o.refineCorners = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, PatchInterfaces) {
  Soup s;
  s.names = {"left", "right"};
  s.addGrid(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 1, 0);
  s.addGrid(Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 1, 1);
  const auto model = s.model();
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  o.refineCorners = false;
  const Vec3 between(1.001, 0.51, 1e-3), border(1e-3, 0.51, 1e-3);
  const Octree on = run(*model, o);
  EXPECT_TRUE(finestAt(on, between));
  EXPECT_FALSE(finestAt(on, border));
  o.refineInterfaces = false;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, OpenEdges) {
  Soup s;
  s.addGrid(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 1);
  const auto model = s.model();
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  EXPECT_TRUE(onlyRoots(run(*model, o))) << "an open edge far from any other surface is no seam";
  o.refineOpen = OpenEdgeRefinement::All;
  EXPECT_TRUE(finestAt(run(*model, o), Vec3(1e-3, 0.51, 1e-3)));
  // A wall that ends a quarter of the finest cell above the floor: an unstitched seam.
  s.addGrid(Vec3(0.5, 0, 0.005), Vec3(0, 1, 0), Vec3(0, 0, 1), 1);
  const auto seam = s.model();
  o.refineOpen = OpenEdgeRefinement::Seams;
  const Vec3 atSeam(0.501, 0.51, 0.006);
  EXPECT_TRUE(finestAt(run(*seam, o), atSeam));
  o.refineOpen = OpenEdgeRefinement::None;
  o.refineCorners = false;
  EXPECT_FALSE(finestAt(run(*seam, o), atSeam));
}

TEST(RefinementCriteria, BalanceAndGrowth) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  const Octree one = run(*model, o);
  EXPECT_TRUE(anyBy(one, RefineReason::Balance));
  o.cellsBetweenLevels = 3;
  EXPECT_GT(run(*model, o).size(), one.size());
}

TEST(RefinementCriteria, BufferNearFeatures) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.refineEdges = true;
  const double finest = 0.02;
  const Vec3 outside(0.51, -3.5 * finest, -3.5 * finest), onSide(0.51, 3.5 * finest, 1e-3);
  o.featureBuffer = 0;
  const Octree off = run(*model, o);
  EXPECT_FALSE(finestAt(off, outside) || finestAt(off, onSide));
  EXPECT_FALSE(anyBy(off, RefineReason::FeatureBuffer));
  o.featureBuffer = 4;
  const Octree on = run(*model, o);
  EXPECT_TRUE(finestAt(on, outside) && finestAt(on, onSide));
  EXPECT_TRUE(anyBy(on, RefineReason::FeatureBuffer));
}

TEST(RefinementCriteria, CellsBesideSmallerCutOnes) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  o.surfaceSize = 0.02;
  const auto coarseBesideCut = [](const Octree& tree) {
    Id found = 0;
    for (Id leaf = 0; leaf < tree.size(); ++leaf)
      for (int side = 0; side < 6 && tree.cut[leaf]; ++side) {
        std::array<Id, 4> beside;
        const int count = tree.faceNeighbours(leaf, side, beside);
        found += count == 1 && !tree.cut[beside[0]] && tree.levels[beside[0]] < tree.levels[leaf];
      }
    return found;
  };
  EXPECT_GT(coarseBesideCut(run(*model, o)), 0);
  o.bufferCells = 1;
  const Octree on = run(*model, o);
  EXPECT_EQ(coarseBesideCut(on), 0);
  EXPECT_TRUE(anyBy(on, RefineReason::SmallerCut));
}

TEST(RefinementCriteria, PatchAndSurfaceSizes) {
  const auto model = cube(1, true).model();
  OctreeDecomposeOptions o = bare(0.02);
  o.patchSizes = {{model->patchNames()[0], 0.05}};
  const Octree patch = run(*model, o);
  EXPECT_LE(edgeAt(patch, Vec3(1e-3, 0.51, 0.51)), 0.05);
  const Id leaf = patch.locate(Vec3(1e-3, 0.51, 0.51));
  EXPECT_EQ(static_cast<RefineReason>(patch.refinedBy[leaf]), RefineReason::PatchSize);
  EXPECT_EQ(patch.refinedByPatch[leaf], 0);
  EXPECT_GT(edgeAt(patch, Vec3(1 - 1e-3, 0.51, 0.51)), 0.05);
  o.patchSizes.clear();
  o.surfaceSize = 0.05;
  EXPECT_EQ(reasonAt(run(*model, o), Vec3(1 - 1e-3, 0.51, 0.51)), RefineReason::SurfaceSize);
  o.surfaceSize = 0;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

/// Every leaf that holds a point of the shape is at most that large, and the far corner stays coarse.
template <class Inside>
void expectSmallWithin(const Octree& tree, double size, RefineReason reason, const Inside& inside) {
  std::mt19937_64 generator(5);
  const Box all = {tree.brick.position({0, 0, 0}),
                   tree.brick.position({tree.brick.extent(0), tree.brick.extent(1), tree.brick.extent(2)})};
  int tried = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = all.lo + randomPoint(generator).cwiseProduct(all.size());
    if (!inside(p)) continue;
    ++tried;
    EXPECT_LE(edgeAt(tree, p), size) << p.transpose();
  }
  EXPECT_GT(tried, 50);
  EXPECT_TRUE(anyBy(tree, reason));
  EXPECT_GT(edgeAt(tree, all.hi - Vec3::Constant(1e-6)), size);
}

TEST(RefinementCriteria, SizesInSpheresAndCylinders) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  const Vec3 centre(0.2, 0.3, 0.4);
  o.spheres = {{centre, 0.25, 0.04}};
  expectSmallWithin(run(*model, o), 0.04, RefineReason::Sphere,
                    [&](const Vec3& p) { return (p - centre).norm() <= 0.25; });
  o.spheres.clear();
  const Vec3 start(0.1, 0.1, 0.1), along = Vec3(1, 2, 3).normalized();
  o.cylinders = {{start, start + 0.6 * along, 0.15, 0.04}};
  expectSmallWithin(run(*model, o), 0.04, RefineReason::Cylinder, [&](const Vec3& p) {
    const double t = along.dot(p - start);
    return t >= 0 && t <= 0.6 && (p - start - t * along).norm() <= 0.15;
  });
  o.cylinders.clear();
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, SizesByDistanceFromAPatch) {
  const auto model = cube(2, true).model();
  OctreeDecomposeOptions o = bare(0.02);
  o.patchDistances = {{model->patchNames()[0], 0.1, 0.02}, {model->patchNames()[0], 0.25, 0.08}};
  const Octree tree = run(*model, o);
  const auto within = [&](double distance) {
    return [distance](const Vec3& p) {
      return Vec3(p - Vec3(0, p[1], p[2]).cwiseMax(0.0).cwiseMin(1.0)).norm() <= distance;
    };
  };
  expectSmallWithin(tree, 0.02, RefineReason::PatchDistance, within(0.1));
  expectSmallWithin(tree, 0.08, RefineReason::PatchDistance, within(0.25));
  EXPECT_GT(edgeAt(tree, Vec3(0.19, 0.5, 0.5)), 0.02);
}

TEST(RefinementCriteria, SizesByDistanceFromASurface) {
  const auto model = cube().model();
  OctreeDecomposeOptions o = bare(0.02);
  const Vec3 centre(0.4, 0.4, 0.4);
  o.sizeSurface = sphere(0.2, centre, 8).model();
  o.surfaceDistances = {{0.0, 0.02}, {0.1, 0.08}};
  const Octree tree = run(*model, o);
  expectSmallWithin(tree, 0.08, RefineReason::SurfaceDistance,
                    [&](const Vec3& p) { return std::sqrt(o.sizeSurface->closest(p).distance2) <= 0.1; });
  EXPECT_LE(edgeAt(tree, o.sizeSurface->corner(0, 0)), 0.02);
}

/// Free leaves that a line across the gap meets, from the first plate to the second.
int freeAcross(const Octree& tree, const Vec3& from, const Vec3& step) {
  int count = 0;
  Id last = kNone;
  for (int i = 0; i <= 400; ++i) {
    const Id leaf = tree.locate(from + i / 400.0 * step);
    count += leaf != last && !tree.cut[leaf];
    last = leaf;
  }
  return count;
}

TEST(RefinementCriteria, GapsGetTheirCells) {
  std::mt19937_64 generator(3);
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 1, 1), Vec3(1, 2, 4)}) {
    const double gap = 0.25;
    const Vec3 n = normal.normalized();
    const auto model = plates(gap, n).model();
    OctreeDecomposeOptions o = bare(0.01);
    o.baseSize = 0.64;
    o.gapCells = 3;
    const Octree tree = run(*model, o);
    EXPECT_TRUE(anyBy(tree, RefineReason::Gap));
    int axis = 0;
    n.maxCoeff(&axis);
    const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), n).toRotationMatrix();
    for (int i = 0; i < 50; ++i) {
      Vec3 p = randomPoint(generator, 0.3, 0.7);
      p[2] = 0;
      EXPECT_GE(freeAcross(tree, turn * p, gap / n[axis] * Vec3::Unit(axis)), 3) << normal.transpose();
    }
    EXPECT_LT(tree.levels[tree.locate(turn * Vec3(0.5, 0.5, 0.125))], tree.brick.maxLevel)
        << "no finer than three cells need";
    o.gapCells = 0;
    EXPECT_TRUE(onlyRoots(run(*model, o)));
  }
}

TEST(RefinementCriteria, CurvatureGivesCellsPerCircle) {
  const double small = 0.1, large = 0.8, pi = 3.14159265358979323846;
  Soup s = sphere(large, Vec3(0, 0, 0), 40);
  s.append(sphere(small, Vec3(2, 0, 0)));
  s.addGrid(Vec3(-1, -1, -1.5), Vec3(2, 0, 0), Vec3(0, 2, 0), 3);
  const auto model = s.model();
  OctreeDecomposeOptions o = bare(0.005);
  o.baseSize = 0.32;
  o.cellsPerCircle = 40;
  const Octree tree = run(*model, o);
  for (double radius : {small, large}) {
    const Vec3 centre(radius == small ? 2 : 0, 0, 0);
    double least = 1, most = 0;
    for (Id leaf = 0; leaf < tree.size(); ++leaf)
      for (Id t : tree.triangles[leaf])
        if ((model->corner(t, 0) - centre).norm() < 1.01 * radius) {
          least = std::min(least, tree.brick.edge(tree.levels[leaf]));
          most = std::max(most, tree.brick.edge(tree.levels[leaf]));
        }
    const double wanted = 2 * pi * radius / o.cellsPerCircle;
    EXPECT_LE(most, 1.05 * wanted) << "radius " << radius;  // a facet is a little less curved
    EXPECT_GE(least, 0.25 * wanted) << "radius " << radius;
  }
  EXPECT_EQ(tree.levels[tree.locate(Vec3(0.9, 0.9, -1.499))], 0) << "a plane has no curvature";
  o.cellsPerCircle = 0;
  EXPECT_TRUE(onlyRoots(run(*model, o)));
}

TEST(RefinementCriteria, RefusesSizesThatMakeNoSense) {
  const auto model = cube().model();
  const auto refused = [&](const std::function<void(OctreeDecomposeOptions&)>& set) {
    OctreeDecomposeOptions o;
    o.featureSize = 0.1;
    set(o);
    EXPECT_THROW(run(*model, o), InputError);
  };
  refused([](auto& o) { o.spheres = {{Vec3::Zero(), 0, 0.1}}; });
  refused([](auto& o) { o.spheres = {{Vec3::Zero(), 1, -0.1}}; });
  refused([](auto& o) { o.cylinders = {{Vec3::Zero(), Vec3::Zero(), 1, 0.1}}; });
  refused([](auto& o) { o.cylinders = {{Vec3::Zero(), Vec3::UnitX(), -1, 0.1}}; });
  refused([](auto& o) { o.patchDistances = {{"nowhere", 0.1, 0.1}}; });
  refused([](auto& o) { o.patchDistances = {{"wall", -0.1, 0.1}}; });
  refused([](auto& o) { o.patchDistances = {{"wall", 0.1, 0}}; });
  refused([](auto& o) { o.surfaceDistances = {{0.1, 0.1}}; });
  refused([](auto& o) { o.gapCells = -1; });
  refused([](auto& o) { o.cellsPerCircle = -1; });
  refused([](auto& o) { o.featureBuffer = -1; });
  refused([](auto& o) { o.maxMemory = std::nan(""); });
}

TEST(RefinementCriteria, BudgetsAreForeseen) {
  const auto model = cube().model();
  const auto sentence = [&](const OctreeDecomposeOptions& o) -> std::string {
    try {
      run(*model, o);
    } catch (const BudgetError& error) {
      return error.what();
    }
    return "";
  };
  OctreeDecomposeOptions o = bare(0.0005);  // 1e10 finest cells in the box, a million at the level of 0.01
  RefineBox box;
  box.box = model->bounds();
  box.size = 0.0005;
  o.boxes = {box};
  EXPECT_NE(sentence(o).find("foreseen"), std::string::npos) << sentence(o);
  o.boxes[0].size = 0.02;
  EXPECT_EQ(sentence(o), "");
  o.maxMemory = 0.05;
  EXPECT_NE(sentence(o).find("0.05 GB"), std::string::npos) << sentence(o);
  o.maxMemory = 1;
  EXPECT_EQ(sentence(o), "");
}

TEST(RefinementCriteria, SameAnswersForAnyThreadCount) {
  const auto model = randomSoup(300, 0.1, 3).model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.03;
  o.gapCells = 2;
  o.cellsPerCircle = 12;
  o.featureDepth = FeatureDepth::AsNeeded;
  o.spheres = {{Vec3::Constant(0.5), 0.2, 0.06}};
  Octree one, four;
  withThreads(1, [&] { one = run(*model, o); });
  withThreads(4, [&] { four = run(*model, o); });
  EXPECT_EQ(one.keys, four.keys);
  EXPECT_EQ(one.refinedBy, four.refinedBy);
  EXPECT_EQ(one.refinedByPatch, four.refinedByPatch);
}

}  // namespace
