// SPDX-License-Identifier: BSD-3-Clause
// Which leaves a triangle is listed in: against brute force, for soups, slivers, triangles on cell faces, far
// from the origin and at extreme scales; and the search in sorted keys behind it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "KeyIndex.h"
#include "Octree.h"
#include "OctreeBuilder.h"
#include "TestSurfaces.h"
#include "TriangleBox.h"

namespace {

using namespace pm;
using namespace pm::testing;

Brick brickAround(const SurfaceModel& model, std::array<std::int32_t, 3> roots, int maxLevel) {
  Brick b;
  b.roots = roots;
  b.maxLevel = maxLevel;
  const Vec3 size = 1.25 * Vec3::Constant(model.bounds().size().maxCoeff());
  for (int a = 0; a < 3; ++a) b.rootSize[a] = size[a] / roots[a];
  b.origin = model.bounds().centre() - 0.5 * size;
  return b;
}

std::vector<Id> cutLeaves(const OctreeBuilder& builder) {
  std::vector<Id> cut;
  for (Id i = 0; i < builder.size(); ++i)
    if (builder.node(i).isLeaf() && builder.node(i).isCut() &&
        builder.node(i).level < builder.brick().maxLevel)
      cut.push_back(i);
  return cut;
}

Octree refined(const SurfaceModel& model, const Brick& brick) {
  OctreeBuilder builder(brick, model);
  for (int level = 0; level < brick.maxLevel; ++level) builder.split(cutLeaves(builder));
  builder.balance(1);
  return std::move(builder).finish();
}

/// Tests every triangle against every leaf.
Id missedByBruteForce(const Octree& tree, const SurfaceModel& model) {
  Id missed = 0;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    const auto list = tree.triangles[leaf];
    for (Id t = 0; t < model.triangleCount(); ++t)
      missed += touches(tree.box(leaf), model.corner(t, 0), model.corner(t, 1), model.corner(t, 2), 0) &&
                !std::binary_search(list.begin(), list.end(), t);
  }
  return missed;
}

void expectAllFound(const Soup& soup, int maxLevel = 4) {
  const auto model = soup.model();
  for (const auto roots : {std::array<std::int32_t, 3>{1, 1, 1}, {3, 2, 5}}) {
    const Octree tree = refined(*model, brickAround(*model, roots, maxLevel));
    EXPECT_TRUE(isComplete(tree));
    EXPECT_TRUE(isBalanced(tree));
    EXPECT_TRUE(findsAllTriangles(tree, *model));
    EXPECT_EQ(missedByBruteForce(tree, *model), 0);
  }
}

TEST(Localisation, RandomSoupsWithNeedles) {
  for (unsigned seed = 0; seed < 4; ++seed) expectAllFound(randomSoup(60, 0.3, seed, 3));
  expectAllFound(randomSoup(40, 5, 9, 4), 3);
}

TEST(Localisation, TrianglesOnCellFaces) {
  // The cube's sides lie on planes between cells of the brick, for n = 4 its edges too.
  const auto model = cube(4).model();
  Brick brick;
  brick.origin = Vec3(-0.5, -0.5, -0.5);
  brick.roots = {2, 2, 2};
  brick.maxLevel = 3;
  const Octree tree = refined(*model, brick);
  EXPECT_TRUE(findsAllTriangles(tree, *model));
  EXPECT_EQ(missedByBruteForce(tree, *model), 0);
  // A side is listed by the cells on both sides of it.
  const Id inner = tree.locate(Vec3(0.01, 0.3, 0.3)), outer = tree.locate(Vec3(-0.01, 0.3, 0.3));
  EXPECT_NE(inner, outer);
  EXPECT_EQ(std::vector<Id>(tree.triangles[inner].begin(), tree.triangles[inner].end()),
            std::vector<Id>(tree.triangles[outer].begin(), tree.triangles[outer].end()));
}

TEST(Localisation, FarFromTheOriginAndAtExtremeScales) {
  const Soup soup = randomSoup(50, 0.3, 3, 5);
  const Soup sides = cube(2);
  for (const double scale : {1e-30, 1e-3, 1e30}) {
    const auto scaled = [&](const Vec3& p) { return Vec3(scale * p); };
    expectAllFound(soup.mapped(scaled), 3);
    expectAllFound(sides.mapped(scaled), 3);
  }
  for (const double size : {1.0, 1e-3}) {
    const auto utm = [&](const Vec3& p) { return Vec3(size * p + Vec3(448262.51, 5411932.68, 110.3)); };
    expectAllFound(soup.mapped(utm), 3);
    expectAllFound(sides.mapped(utm), 3);
  }
}

// The habit of p4est's test of balance: the predicates before and after each step.
TEST(Localisation, ListsStayCompleteWhileTheTreeChanges) {
  const auto model = randomSoup(300, 0.1, 11).model();
  OctreeBuilder builder(brickAround(*model, {2, 2, 2}, 6), *model);
  builder.split(cutLeaves(builder));
  builder.balance(1);
  EXPECT_TRUE(isBalanced(builder.finish()));
  EXPECT_TRUE(findsAllTriangles(builder.finish(), *model));
  for (int level = 1; level < 6; ++level) {
    const Id leaf = builder.find({63, 63, 63}, level);
    builder.split({leaf});
    EXPECT_TRUE(builder.triangles(builder.node(leaf)).empty()) << "the list of a split node is gone";
  }
  EXPECT_TRUE(isComplete(builder.finish()));
  EXPECT_FALSE(isBalanced(builder.finish()));
  EXPECT_TRUE(findsAllTriangles(builder.finish(), *model));
  builder.balance(1);
  EXPECT_TRUE(isBalanced(builder.finish()));
  EXPECT_TRUE(findsAllTriangles(builder.finish(), *model));
}

TEST(Localisation, WrongListsAreNoticed) {
  const auto model = randomSoup(80, 0.2, 5).model();
  const Octree tree = refined(*model, brickAround(*model, {1, 1, 1}, 3));
  ASSERT_TRUE(findsAllTriangles(tree, *model));
  const auto touched = [&](std::size_t least) {
    Id leaf = 0;
    while (tree.triangles[leaf].size() < least) ++leaf;
    return leaf;
  };
  Octree without = tree;  // every list in turn loses a triangle that truly touches: its neighbour stands in
  const Id two = touched(2);
  without.triangles.values[tree.triangles.offsets[two]] =
      without.triangles.values[tree.triangles.offsets[two] + 1];
  EXPECT_FALSE(findsAllTriangles(without, *model)) << "repeated instead of listed";
  Octree unsorted = tree;
  std::swap(unsorted.triangles.values[tree.triangles.offsets[two]],
            unsorted.triangles.values[tree.triangles.offsets[two] + 1]);
  EXPECT_FALSE(findsAllTriangles(unsorted, *model)) << "not ascending";
  Octree flag = tree;
  flag.cut[two] = 0;
  EXPECT_FALSE(findsAllTriangles(flag, *model)) << "cut does not tell";
  Octree lost = tree;  // the last triangle of a list goes, the rest stays in order
  lost.triangles.values.erase(lost.triangles.values.begin() + tree.triangles.offsets[two + 1] - 1);
  for (Id i = two + 1; i <= tree.size(); ++i) --lost.triangles.offsets[i];
  EXPECT_FALSE(findsAllTriangles(lost, *model)) << "a triangle is missing";
  Octree foreign = tree;  // a list of one gets another triangle
  Id one = 0;
  while (tree.triangles[one].size() != 1) ++one;
  Id& entry = foreign.triangles.values[tree.triangles.offsets[one]];
  entry = (entry + 1) % model->triangleCount();
  EXPECT_FALSE(findsAllTriangles(foreign, *model)) << "the wrong triangle";
}

TEST(Localisation, SameListsForAnyNumberOfThreads) {
  // More triangles in the one root cell than a task takes at once.
  const auto model = randomSoup(20000, 0.02, 2).model();
  const Brick brick = brickAround(*model, {1, 1, 1}, 4);
  std::vector<Octree> trees;
  for (int threads : {1, 2, 4}) withThreads(threads, [&] { trees.push_back(refined(*model, brick)); });
  for (int k = 1; k < 3; ++k) {
    EXPECT_EQ(trees[0].keys, trees[k].keys);
    EXPECT_EQ(trees[0].triangles.offsets, trees[k].triangles.offsets);
    EXPECT_EQ(trees[0].triangles.values, trees[k].triangles.values);
  }
  EXPECT_TRUE(findsAllTriangles(trees[0], *model));
}

TEST(TriangleBox, ChildrenAtOnceAgreeWithEachByItself) {
  std::mt19937_64 g(4);
  const ChildPlanes cell{Vec3(-1, -1, -1), Vec3(0, 0, 0), Vec3(1, 1, 1)};
  int some = 0;
  for (int i = 0; i < 20000; ++i) {
    const double size = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 2 : 40;
    const Vec3 a = randomPoint(g, -1.5, 1.5), b = a + size * randomPoint(g, -1, 1);
    const Vec3 c =
        i % 5 == 0 ? Vec3(a + 0.4 * (b - a) + 1e-9 * randomPoint(g)) : Vec3(a + size * randomPoint(g, -1, 1));
    const unsigned together = touchedChildren(cell, a, b, c, 1e-9);
    unsigned alone = 0;
    for (unsigned k = 0; k < 8; ++k) {
      Box child = {cell.lo, cell.middle};
      for (int axis = 0; axis < 3; ++axis)
        if (k >> axis & 1) child.lo[axis] = 0, child.hi[axis] = 1;
      alone |= unsigned(touches(child, a, b, c, 1e-9)) << k;
    }
    EXPECT_EQ(together, alone) << i;
    some += together != 0 && together != 255;
  }
  EXPECT_GT(some, 5000);
}

TEST(TriangleBox, SliversAreNotLost) {
  // A point of the sliver inside the box proves that it touches, whatever its normal comes out as.
  std::mt19937_64 g(6);
  const Box box = {Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  for (int i = 0; i < 20000; ++i) {
    const Vec3 inside = randomPoint(g, -0.99, 0.99), direction = randomPoint(g, -1, 1);
    const double reach = std::pow(10.0, i % 5), height = std::pow(10.0, -8 - i % 9);
    const Vec3 a = inside - reach * direction, b = inside + reach * direction;
    const Vec3 c = inside + 0.3 * reach * direction + height * randomPoint(g, -1, 1);
    EXPECT_TRUE(touches(box, a, b, c, 1e-9 * reach)) << i;
  }
}

TEST(KeyIndex, AgreesWithBinarySearch) {
  std::mt19937_64 g(8);
  for (const int count : {0, 1, 2, 50, 5000})
    for (const int spread : {0, 20, 40, 62}) {
      // Half of the keys are spread over the range, half in a tight cluster.
      std::vector<Key> keys;
      for (int i = 0; i < count; ++i)
        keys.push_back(i % 2 ? g() & ((Key(1) << spread) - 1) : (Key(1) << spread) / 3 + g() % 4096);
      std::sort(keys.begin(), keys.end());
      keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
      KeyIndex index;
      index.build(keys);
      const auto check = [&](Key key) {
        const auto place = std::upper_bound(keys.begin(), keys.end(), key) - keys.begin();
        EXPECT_EQ(index.upperBound(keys, key), place);
        const bool there = std::binary_search(keys.begin(), keys.end(), key);
        EXPECT_EQ(index.find(keys, key), there ? static_cast<Id>(place) - 1 : kNone);
      };
      for (Key key : keys) {
        check(key);
        check(key + 1);
        if (key > 0) check(key - 1);
      }
      for (int i = 0; i < 200; ++i) check(g() >> 1);
      check(0);
    }
}

}  // namespace
