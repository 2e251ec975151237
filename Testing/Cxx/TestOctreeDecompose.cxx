// SPDX-License-Identifier: BSD-3-Clause
// The octree around a geometry: sizes, criteria, domains, budgets and refused options.
#include <gtest/gtest.h>

#include <cmath>

#include "OctreeDecompose.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

Octree run(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  Monitor monitor;
  return decompose(model, o, monitor);
}

double smallestCut(const Octree& tree) {
  int level = 0;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (tree.cut[leaf]) level = std::max<int>(level, tree.levels[leaf]);
  return tree.brick.edge(level);
}

TEST(OctreeDecompose, IsCompleteBalancedAndAsFineAsAskedOnEdges) {
  const auto model = cube().model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.05;
  o.featureDepth = FeatureDepth::Full;
  const Octree tree = run(*model, o);
  EXPECT_TRUE(isComplete(tree));
  EXPECT_TRUE(isBalanced(tree));
  EXPECT_DOUBLE_EQ(smallestCut(tree), 0.05);
  // The cube's edges are sharp: the leaf on the middle of one is of the finest level.
  EXPECT_EQ(tree.levels[tree.locate(Vec3(0.5, 1e-9, 1e-9))], tree.brick.maxLevel);
  // The middle of a flat side needs no refinement.
  EXPECT_LT(tree.levels[tree.locate(Vec3(0.5, 0.5, 1e-9))], tree.brick.maxLevel);
}

TEST(OctreeDecompose, DomainEndsExactlyOnCellFaces) {
  const auto model = cube().model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.125;
  o.featureDepth = FeatureDepth::Full;
  o.baseSize = 0.9;
  o.useDomain = true;
  o.domain.add(Vec3(-1, -2, -1.5));
  o.domain.add(Vec3(4, 2, 3));
  const Octree tree = run(*model, o);
  EXPECT_TRUE(tree.brick.sidesArePatches);
  Coord far{tree.brick.extent(0), tree.brick.extent(1), tree.brick.extent(2)};
  EXPECT_LT((tree.brick.position({0, 0, 0}) - o.domain.lo).norm(), 1e-15);
  EXPECT_LT((tree.brick.position(far) - o.domain.hi).norm(), 1e-14);
  EXPECT_LE(smallestCut(tree), 0.125 + 1e-12);
}

TEST(OctreeDecompose, BoxesPatchesAndSurfaceSizesAreKept) {
  const auto model = cube(1, true).model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.02;
  o.refineEdges = false;
  o.separate = false;
  o.normalAngle = 0;
  o.patchSizes = {{model->patchNames()[0], 0.06}};
  RefineBox box;
  box.box.add(Vec3(0.4, 0.4, 0.4));
  box.box.add(Vec3(0.6, 0.6, 0.6));
  box.size = 0.1;
  o.boxes.push_back(box);
  const Octree tree = run(*model, o);
  EXPECT_LE(tree.brick.edge(tree.levels[tree.locate(Vec3(0.5, 0.5, 0.5))]), 0.1);
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    for (Id t : tree.triangles[leaf])
      EXPECT_TRUE(model->patchOf(t) != 0 || tree.brick.edge(tree.levels[leaf]) <= 0.06);
}

TEST(OctreeDecompose, FacingPlatesAreSeparated) {
  Soup plates;
  plates.addGrid(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 1);
  plates.addGrid(Vec3(0, 0, 0.1), Vec3(1, 0, 0), Vec3(0, 1, 0), 1);
  const auto model = plates.model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.02;
  o.refineEdges = false;
  const Octree with = run(*model, o);
  EXPECT_FALSE(with.cut[with.locate(Vec3(0.5, 0.5, 0.05))]) << "no free cell between the plates";
  o.separate = false;
  const Octree without = run(*model, o);
  EXPECT_TRUE(without.cut[without.locate(Vec3(0.5, 0.5, 0.05))]);
}

TEST(OctreeDecompose, RefusesWhatCannotBeMeshed) {
  const auto model = cube().model();
  OctreeDecomposeOptions o;
  o.featureSize = -1;
  EXPECT_THROW(run(*model, o), InputError);
  o.featureSize = std::nan("");
  EXPECT_THROW(run(*model, o), InputError);
  o.featureSize = 2;
  EXPECT_THROW(run(*model, o), InputError);
  o.featureSize = 1e-9;
  EXPECT_THROW(run(*model, o), InputError);
  o.featureSize = 0.001;
  o.featureDepth = FeatureDepth::Full;
  o.maxCells = 10000;
  EXPECT_THROW(run(*model, o), BudgetError);
  o = {};
  o.patchSizes = {{"nowhere", 0.1}};
  EXPECT_THROW(run(*model, o), InputError);
  o = {};
  o.useDomain = true;
  o.domain.add(Vec3(5, 5, 5));
  o.domain.add(Vec3(6, 6, 6));
  EXPECT_THROW(run(*model, o), InputError);
}

TEST(OctreeDecompose, ScaleAndOffsetDoNotMatter) {
  for (FeatureDepth depth : {FeatureDepth::AsNeeded, FeatureDepth::Full}) {
    OctreeDecomposeOptions o;
    o.featureDepth = depth;
    o.featureSize = 0.1;
    const Id expected = run(*cube(4).model(), o).size();
    for (double scale : {1e-30, 1e-3, 1e30}) {
      const auto model = cube(4).mapped([&](const Vec3& p) { return Vec3(scale * p); }).model();
      o.featureSize = 0.1 * scale;
      EXPECT_EQ(run(*model, o).size(), expected) << "scale " << scale;
    }
  }
}

TEST(OctreeDecompose, StopsWhenAsked) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  const auto model = cube().model();
  EXPECT_THROW(decompose(*model, {}, stop), AbortError);
}

TEST(OctreeDecompose, SameLeavesForAnyThreadCount) {
  const auto model = randomSoup(300, 0.1, 3).model();
  OctreeDecomposeOptions o;
  o.featureSize = 0.03;
  Octree one, four;
  withThreads(1, [&] { one = run(*model, o); });
  withThreads(4, [&] { four = run(*model, o); });
  EXPECT_EQ(one.keys, four.keys);
  EXPECT_EQ(one.triangles.values, four.triangles.values);
}

}  // namespace
