// SPDX-License-Identifier: BSD-3-Clause
// Keys, look-up and the predicates of the linear octree, and the builder that grows it.
#include <gtest/gtest.h>

#include <random>

#include "Octree.h"
#include "OctreeBuilder.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

Brick unitBrick(int maxLevel) {
  Brick b;
  b.origin = Vec3(-0.5, -0.5, -0.5);
  b.roots = {2, 3, 2};
  b.maxLevel = maxLevel;
  return b;
}

TEST(Octree, KeysGiveBackTheirCoordinates) {
  std::mt19937 g(1);
  std::uniform_int_distribution<std::int32_t> any(0, (1 << kCoordBits) - 1);
  for (int i = 0; i < 1000; ++i) {
    const Coord c{any(g), any(g), any(g)};
    EXPECT_EQ(decode(encode(c)), c);
  }
}

TEST(Octree, PredicatesFollowRefinementAndBalance) {
  const auto model = cube().model();
  OctreeBuilder builder(unitBrick(5), *model);
  EXPECT_TRUE(isBalanced(builder.finish()));
  // Split one corner down to the finest level: complete, not balanced.
  for (int level = 0; level < 5; ++level) builder.split({builder.find({31, 31, 31}, level)});
  EXPECT_TRUE(isComplete(builder.finish()));
  EXPECT_FALSE(isBalanced(builder.finish()));
  builder.balance(1);
  EXPECT_TRUE(isComplete(builder.finish()));
  EXPECT_TRUE(isBalanced(builder.finish()));
}

TEST(Octree, WiderGradingKeepsMoreCellsBetweenLevels) {
  const auto model = cube().model();
  Id leaves[2];
  for (int k = 0; k < 2; ++k) {
    OctreeBuilder builder(unitBrick(5), *model);
    for (int level = 0; level < 5; ++level) builder.split({builder.find({31, 31, 31}, level)});
    builder.balance(1 + 2 * k);
    EXPECT_TRUE(isBalanced(builder.finish()));
    leaves[k] = builder.leafCount();
  }
  EXPECT_GT(leaves[1], leaves[0]);
}

TEST(Octree, MissingLeafIsNoticed) {
  const auto model = cube().model();
  Octree tree = OctreeBuilder(unitBrick(2), *model).finish();
  tree.keys.erase(tree.keys.begin() + 3);
  tree.levels.erase(tree.levels.begin() + 3);
  tree.index();
  EXPECT_FALSE(isComplete(tree));
}

TEST(Octree, FindAgreesWithBruteForceAndNeighboursTouch) {
  const auto model = cube().model();
  OctreeBuilder builder(unitBrick(4), *model);
  for (int level = 0; level < 4; ++level) builder.split({builder.find({20, 20, 20}, level)});
  builder.balance(1);
  const Octree tree = builder.finish();
  std::mt19937 g(2);
  for (int i = 0; i < 500; ++i) {
    const Coord c{int(g() % 32), int(g() % 48), int(g() % 32)};
    Id brute = kNone;
    for (Id leaf = 0; leaf < tree.size(); ++leaf) {
      const Coord lo = tree.corner(leaf);
      const int span = tree.brick.span(tree.levels[leaf]);
      bool in = true;
      for (int a = 0; a < 3; ++a) in = in && c[a] >= lo[a] && c[a] < lo[a] + span;
      if (in) brute = leaf;
    }
    EXPECT_EQ(tree.find(c), brute);
  }
  EXPECT_EQ(tree.find({-1, 0, 0}), kNone);
  EXPECT_EQ(tree.find({32, 0, 0}), kNone);
  std::array<Id, 4> n, back;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    for (int side = 0; side < 6; ++side) {
      const int count = tree.faceNeighbours(leaf, side, n);
      for (int k = 0; k < count; ++k) {
        const int returning = tree.faceNeighbours(n[k], side ^ 1, back);
        EXPECT_TRUE(std::find(back.begin(), back.begin() + returning, leaf) != back.begin() + returning);
      }
    }
}

TEST(Octree, EveryTriangleIsInEveryLeafItTouchesAndInNoOther) {
  const auto model = randomSoup(200, 0.2, 7, 10).model();
  Brick brick = unitBrick(3);
  brick.origin = Vec3(-0.6, -0.6, -0.6);
  OctreeBuilder builder(brick, *model);
  for (int level = 0; level < 3; ++level) {
    std::vector<Id> cut;
    for (Id i = 0; i < builder.size(); ++i)
      if (builder.node(i).isLeaf() && builder.node(i).isCut() && builder.node(i).level < 3) cut.push_back(i);
    builder.split(cut);
  }
  const Octree tree = builder.finish();
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    const auto list = tree.triangles[leaf];
    const Box box = tree.box(leaf);
    const double slack = 1e-6 * box.size().maxCoeff();
    for (Id t = 0; t < model->triangleCount(); ++t) {
      // The closest point of the triangle to the box decides, found by dense sampling of the triangle.
      bool inside = false;
      for (int i = 0; i <= 40 && !inside; ++i)
        for (int j = 0; i + j <= 40 && !inside; ++j) {
          const double u = i / 40.0, v = j / 40.0;
          inside = box.contains((1 - u - v) * model->corner(t, 0) + u * model->corner(t, 1) +
                                v * model->corner(t, 2));
        }
      const bool listed = std::binary_search(list.begin(), list.end(), t);
      EXPECT_TRUE(listed || !inside) << "leaf " << leaf << " triangle " << t;
      Box grown = box, own;
      grown.lo.array() -= slack, grown.hi.array() += slack;
      for (int k = 0; k < 3; ++k) own.add(model->corner(t, k));
      EXPECT_TRUE(!listed || own.overlaps(grown));
    }
  }
}

}  // namespace
