// SPDX-License-Identifier: BSD-3-Clause
// Rooms that a region takes in through openings a few cells wide are noticed, and nothing else is.
#include "LeakedRooms.h"

#include <gtest/gtest.h>

#include <cmath>

#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "TestRooms.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kCell = 0.08;

struct Listener : Monitor {
  void warning(const std::string& sentence) override { warnings.push_back(sentence); }
  std::vector<std::string> warnings;
};

/// A profile (distance from the z axis, z) turned around the axis.
Soup turned(const std::vector<std::array<double, 2>>& profile) {
  constexpr int kFacets = 40;
  Soup soup;
  const auto point = [&](std::size_t i, int k) {
    const double angle = 2 * 3.14159265358979323846 * (k % kFacets) / kFacets;
    return Vec3(profile[i][0] * std::cos(angle), profile[i][0] * std::sin(angle), profile[i][1]);
  };
  for (std::size_t i = 1; i < profile.size(); ++i)
    for (int k = 0; k < kFacets; ++k) {
      const Vec3 a = point(i - 1, k), b = point(i - 1, k + 1), c = point(i, k + 1), d = point(i, k);
      if (profile[i - 1][0] > 0) soup.add(a, b, c, 0);
      if (profile[i][0] > 0) soup.add(a, c, d, 0);
    }
  return soup;
}

/// A wall between spheres of radius 0.8 and 1, open where the angle from the pole is smaller; 0 = closed.
Soup shell(double opening) {
  constexpr int kRows = 20;
  constexpr double pi = 3.14159265358979323846;
  std::vector<std::array<double, 2>> profile;
  for (double radius : {1.0, 0.8})
    for (int i = 0; i <= kRows; ++i) {
      const double part = double(radius < 1 ? kRows - i : i) / kRows, angle = pi - (pi - opening) * part;
      const bool pole = part == 0 || (part == 1 && opening == 0);
      profile.push_back({pole ? 0 : radius * std::sin(angle), radius * std::cos(angle)});
    }
  return turned(profile);
}

RoomLeaks painted(const Soup& soup, double cell, const PaintFrontOptions& options, Listener& listener) {
  OctreeDecomposeOptions octree;
  octree.featureSize = octree.surfaceSize = cell;
  const auto model = soup.model();
  PaintFrontReport report;
  paintFront(decompose(*model, octree, listener), *model, options, listener, &report);
  return report.leaked;
}

PaintFrontOptions outside() {
  PaintFrontOptions options;
  options.region = Region::Outside;
  return options;
}

TEST(LeakedRooms, AShellWithAnOpeningIsWarnedOf) {
  Listener listener;
  const double angle = 0.25, width = 2 * 0.8 * std::sin(angle), height = 0.8 * std::cos(angle);
  const RoomLeaks found = painted(shell(angle), kCell, outside(), listener);
  ASSERT_EQ(found.rooms.size(), 1u);
  EXPECT_LT(found.rooms[0].point.norm(), 0.1);
  EXPECT_NEAR(found.rooms[0].width, 1.6, 0.2);
  EXPECT_NEAR(found.rooms[0].opening, width, 0.05 * width);
  EXPECT_LT((found.rooms[0].place - Vec3(0, 0, height)).norm(), kCell);
  ASSERT_EQ(found.leaks.size(), 1u);
  const Leak& leak = found.leaks[0];
  EXPECT_LT((leak.bottleneck - Vec3(0, 0, height)).norm(), kCell);
  EXPECT_EQ(leak.path.front(), found.rooms[0].point);
  EXPECT_GT(leak.path.back()[2], std::cos(angle)) << "beyond the outer rim";
  ASSERT_EQ(listener.warnings.size(), 1u);
  for (const char* part : {"a room", "Close Holes", "keep-out", "cells"})
    EXPECT_NE(listener.warnings[0].find(part), std::string::npos) << listener.warnings[0];
}

TEST(LeakedRooms, ClosedBodiesAndWideOpeningsAreSilent) {
  Listener listener;
  EXPECT_TRUE(painted(shell(0), kCell, outside(), listener).rooms.empty()) << "closed";
  EXPECT_TRUE(painted(shell(1.57), kCell, outside(), listener).rooms.empty()) << "a cup";
  EXPECT_TRUE(painted(shell(0.6), kCell, outside(), listener).rooms.empty()) << "a room 1.8 times as wide";
  EXPECT_TRUE(painted(shell(0.3), 0.04, outside(), listener).rooms.empty()) << "12 cells wide";
  EXPECT_TRUE(listener.warnings.empty());
}

TEST(LeakedRooms, OffOnRequestAndAnErrorForAKeepOutPoint) {
  Listener listener;
  PaintFrontOptions options = outside();
  options.reportLeaks = false;
  EXPECT_TRUE(painted(shell(0.25), kCell, options, listener).rooms.empty());
  options = outside();
  options.keepOut = {Vec3(0, 0, 0)};
  EXPECT_THROW(painted(shell(0.25), kCell, options, listener), LeakError);
  EXPECT_TRUE(listener.warnings.empty());
}

/// Two rooms 1 and 1.4 long with a square door of this width between them.
Soup twoRooms(double door) {
  const double lo = 0.5 - 0.5 * door, hi = 0.5 + 0.5 * door;
  return rooms({std::vector<double>{0.013, 1.013, 1.213, 2.613}, {0, lo, hi, 1}, {0, lo, hi, 1}}, 1,
               [=](const Vec3& c) {
                 const bool inDoor = c[1] > lo && c[1] < hi && c[2] > lo && c[2] < hi;
                 return c[0] < 1.013 || c[0] > 1.213 || inDoor ? 1 : 0;
               });
}

TEST(LeakedRooms, RoomsInsideTheMainPartIsTheLargerOneOrHoldsTheSeed) {
  Listener listener;
  RoomLeaks found = painted(twoRooms(0.2), 0.05, {}, listener);
  ASSERT_EQ(found.rooms.size(), 1u);
  EXPECT_LT(found.rooms[0].point[0], 1);
  EXPECT_NEAR(found.rooms[0].opening, 0.2, 0.01);
  ASSERT_EQ(found.leaks.size(), 1u);
  EXPECT_LT(std::abs(found.leaks[0].bottleneck[0] - 1.113), 0.15);
  PaintFrontOptions options;
  options.region = Region::Points;
  options.points = {Vec3(0.5, 0.5, 0.5)};
  found = painted(twoRooms(0.2), 0.05, options, listener);
  ASSERT_EQ(found.rooms.size(), 1u);
  EXPECT_GT(found.rooms[0].point[0], 1.213);
  EXPECT_TRUE(painted(twoRooms(0.6), 0.05, {}, listener).rooms.empty()) << "a doorway";
}

TEST(LeakedRooms, SameForAnyNumberOfThreads) {
  Listener listener;
  RoomLeaks one, four;
  withThreads(1, [&] { one = painted(shell(0.25), kCell, outside(), listener); });
  withThreads(4, [&] { four = painted(shell(0.25), kCell, outside(), listener); });
  ASSERT_EQ(one.leaks.size(), four.leaks.size());
  EXPECT_EQ(one.leaks[0].path, four.leaks[0].path);
  EXPECT_EQ(listener.warnings[0], listener.warnings[1]);
}

}  // namespace
