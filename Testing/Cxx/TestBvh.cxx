// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "Bvh.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::randomPoint;

/// Boxes of very different sizes, some of them points, some equal.
std::vector<Box> randomBoxes(int count, double scale, const Vec3& origin, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::vector<Box> boxes(count);
  for (int i = 0; i < count; ++i) {
    const Vec3 at = origin + scale * randomPoint(generator);
    boxes[i].add(at);
    if (i % 5 != 0) boxes[i].add(at + scale * std::pow(0.1, i % 4) * randomPoint(generator));
    if (i % 7 == 0) boxes[i] = boxes[i / 2];
  }
  return boxes;
}

struct Case {
  int count;
  double scale;
  Vec3 origin;
};

/// From one box to many, tiny, huge and far from the origin.
std::vector<Case> cases() {
  const Vec3 zero = Vec3::Zero();
  return {{1, 1, zero},   {2, 1, zero},      {5, 1, zero},      {17, 1e-30, zero},
          {300, 1, zero}, {300, 1e30, zero}, {300, 1e-3, zero}, {300, 10, Vec3(5e5, 5.4e6, 80)},
          {2000, 1, zero}};
}

/// Places in, around and far from the boxes.
std::vector<Vec3> places(const Case& c, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::vector<Vec3> out;
  for (int i = 0; i < 60; ++i) out.push_back(c.origin + c.scale * randomPoint(generator));
  for (double far : {3.0, 1e3, 1e9}) out.push_back(c.origin + far * c.scale * randomPoint(generator));
  return out;
}

TEST(Bvh, NearestVisitsWhatCouldBeNearest) {
  for (const Case& c : cases()) {
    const std::vector<Box> boxes = randomBoxes(c.count, c.scale, c.origin, 1);
    const Bvh bvh(boxes);
    for (const Vec3& p : places(c, 2)) {
      double expected = std::numeric_limits<double>::infinity(), found = expected;
      for (const Box& box : boxes) expected = std::min(expected, box.distance2(p));
      bvh.nearest(
          p, [&] { return found; },
          [&](Id slot) { found = std::min(found, boxes[bvh.order()[slot]].distance2(p)); });
      EXPECT_EQ(found, expected) << c.count << " boxes of " << c.scale;
    }
  }
}

TEST(Bvh, NearestVisitsAllWithinAFixedBound) {
  for (const Case& c : cases()) {
    const std::vector<Box> boxes = randomBoxes(c.count, c.scale, c.origin, 3);
    const Bvh bvh(boxes);
    for (const Vec3& p : places(c, 4)) {
      const double bound2 = std::pow(0.2 * c.scale, 2);
      std::set<Id> visited;
      bvh.nearest(
          p, [&] { return bound2; }, [&](Id slot) { visited.insert(bvh.order()[slot]); });
      for (Id i = 0; i < c.count; ++i)
        if (boxes[i].distance2(p) <= bound2) EXPECT_TRUE(visited.count(i)) << "box " << i;
    }
  }
}

TEST(Bvh, NearestEndsWhenTheBoundFallsBelowZero) {
  const std::vector<Box> boxes = randomBoxes(2000, 1, Vec3::Zero(), 5);
  const Bvh bvh(boxes);
  int visits = 0;
  bvh.nearest(
      boxes[0].centre(), [&] { return visits > 0 ? -1.0 : 1e300; }, [&](Id) { ++visits; });
  EXPECT_GE(visits, 1);
  EXPECT_LE(visits, Bvh::kLeafSize);
}

TEST(Bvh, OverlappingVisitsEachOverlapOnce) {
  for (const Case& c : cases()) {
    const std::vector<Box> boxes = randomBoxes(c.count, c.scale, c.origin, 6);
    const Bvh bvh(boxes);
    for (const Box& box : randomBoxes(40, c.scale, c.origin, 7)) {
      std::vector<Id> visited;
      bvh.overlapping(box, [&](Id slot) { visited.push_back(bvh.order()[slot]); });
      std::sort(visited.begin(), visited.end());
      EXPECT_TRUE(std::adjacent_find(visited.begin(), visited.end()) == visited.end());
      for (Id i = 0; i < c.count; ++i)
        if (boxes[i].overlaps(box))
          EXPECT_TRUE(std::binary_search(visited.begin(), visited.end(), i)) << "box " << i;
      EXPECT_FALSE(bvh.anyOverlapping(box, [](Id) { return false; }));
      EXPECT_EQ(bvh.anyOverlapping(box, [](Id) { return true; }), !visited.empty());
    }
  }
}

// Boxes of children hold the items below, and childValues() sees each item once: a search that enters by one
// or the other finds the same.
TEST(Bvh, ChildrenHoldTheirItems) {
  for (const Case& c : cases()) {
    const std::vector<Box> boxes = randomBoxes(c.count, c.scale, c.origin, 8);
    const Bvh bvh(boxes);
    const auto least = bvh.childValues<Id>([&](Id slot) { return bvh.order()[slot]; },
                                           [](Id& value, Id other) { value = std::min(value, other); });
    for (Id i = 0; i < c.count; ++i) {
      const auto byBox = [&](Id, const Box& box) {
        return box.contains(boxes[i].lo) && box.contains(boxes[i].hi);
      };
      const auto byValue = [&](Id child, const Box&) { return least[child] <= i; };
      const auto isIt = [&](Id slot) { return bvh.order()[slot] == i; };
      EXPECT_TRUE(bvh.any(byBox, isIt)) << "box " << i << " of " << c.count;
      EXPECT_TRUE(bvh.any(byValue, isIt)) << "box " << i << " of " << c.count;
    }
  }
}

TEST(Bvh, OfNothing) {
  const Bvh bvh;
  int visits = 0;
  bvh.nearest(
      Vec3::Zero(), [] { return 1.0; }, [&](Id) { ++visits; });
  bvh.overlapping(Box(), [&](Id) { ++visits; });
  EXPECT_FALSE(bvh.any([](Id, const Box&) { return true; }, [](Id) { return true; }));
  EXPECT_EQ(visits, 0);
}

}  // namespace
}  // namespace pm
