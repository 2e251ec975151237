// SPDX-License-Identifier: BSD-3-Clause
// Free space that is too narrow for the leaves is reported; thin walls are not.
#include "NarrowPassages.h"

#include <gtest/gtest.h>

#include <cmath>

#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "TestRooms.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kSize = 0.05;  // edge of the finest leaves

PaintFrontReport look(const Soup& soup, const PaintFrontOptions& options = {},
                      OctreeDecomposeOptions o = {}) {
  const auto model = soup.model();
  o.featureSize = kSize;
  Monitor monitor;
  const Octree tree = decompose(*model, o, monitor);
  EXPECT_DOUBLE_EQ(tree.brick.edge(tree.brick.maxLevel), kSize);
  PaintFrontReport report;
  paintFront(tree, *model, options, monitor, &report);
  return report;
}

/// A cube of edge 1 with a slot behind one side: ten leaves deep, eight wide, `width` high.
Soup slot(double width, double turn = 0) {
  const double z = 0.513;
  const Soup soup = rooms({std::vector<double>{0.01, 1.01, 1.51}, {0, 0.3, 0.7, 1}, {0, z, z + width, 1}}, 1,
                          [&](const Vec3& c) {
                            const bool inSlot = c[1] > 0.3 && c[1] < 0.7 && c[2] > z && c[2] < z + width;
                            return c[0] < 1.01 || inSlot ? 1 : 0;
                          });
  return soup.mapped([&](const Vec3& p) {
    return Vec3(std::cos(turn) * p[0] + std::sin(turn) * p[2], p[1],
                std::cos(turn) * p[2] - std::sin(turn) * p[0]);
  });
}

TEST(NarrowPassages, ASlotTooNarrowForALeafIsOnePlace) {
  for (double turn : {0.0, 0.3})
    for (double width : {0.3, 0.5, 1.0, 1.5}) {
      const PaintFrontReport report = look(slot(width * kSize, turn));
      ASSERT_EQ(report.invisible.places.size(), 1u) << width << " leaves wide, turned by " << turn;
      const NarrowPlace& place = report.invisible.places[0];
      EXPECT_NEAR(place.narrowest, width * kSize, 1e-9);
      EXPECT_NEAR(place.median, width * kSize, 1e-9);
      const double sum = 2 * (std::cos(turn) + std::sin(turn));
      EXPECT_NEAR(place.featureSize, width * kSize / sum, 1e-9);
      EXPECT_GT(place.cells, 40) << "of some 80 leaves";
      EXPECT_EQ(place.patches, (std::vector<Id>{0}));
      EXPECT_EQ(static_cast<Id>(report.invisible.cells.size()), place.cells);
      for (const NarrowCell& cell : report.invisible.cells) {
        EXPECT_NEAR(cell.width, width * kSize, 1e-9);
        EXPECT_TRUE(place.bounds.contains(cell.point));
      }
      ASSERT_EQ(report.notes.size(), 1u);
    }
}

TEST(NarrowPassages, ASlotThatLeavesFitIntoIsNone) {
  for (double turn : {0.0, 0.3}) {
    const PaintFrontReport report = look(slot(3 * kSize, turn));
    EXPECT_TRUE(report.invisible.places.empty());
    EXPECT_TRUE(report.invisible.cells.empty());
    EXPECT_TRUE(report.notes.empty());
  }
}

TEST(NarrowPassages, AThinPlateIsNone) {
  for (double thickness : {0.0, 0.3, 0.7, 1.2, 1.8}) {
    const double z = 0.513, d = thickness * kSize;
    Soup soup = rooms({std::vector<double>{0.01, 0.3, 1.01}, {0, 1}, {0, z, z + std::max(d, 1e-3), 1}}, 1,
                      [&](const Vec3& c) { return c[0] > 0.3 && c[2] > z && c[2] < z + d ? 0 : 1; });
    if (thickness == 0) soup.addGrid(Vec3(0.3, 0, z), Vec3(0.71, 0, 0), Vec3(0, 1, 0), 1);
    EXPECT_TRUE(look(soup).invisible.places.empty()) << thickness << " leaves thick";
  }
}

TEST(NarrowPassages, GapsWhoseMiddleLiesBeyondTheDomainAreLeftOut) {
  const double width = 0.5 * kSize, sideInSlot = 0.513 + 0.3 * width;
  PaintFrontOptions options;
  options.region = Region::Everything;
  OctreeDecomposeOptions o;
  o.useDomain = true;
  o.domain = Box{Vec3(-0.5, -0.5, sideInSlot - 32 * kSize), Vec3(2.7, 1.1, sideInSlot)};
  const PaintFrontReport report = look(slot(width), options, o);
  for (const NarrowCell& cell : report.invisible.cells) EXPECT_LE(cell.point[2], sideInSlot);
}

TEST(NarrowPassages, ADuctLeadsToTheRoomBehindIt) {
  const double y = 0.41, z = 0.513, d = 0.7 * kSize;
  const Soup soup = rooms({std::vector<double>{0.01, 1.01, 1.51, 2.01}, {0, y, y + d, 1}, {0, z, z + d, 1}},
                          1, [&](const Vec3& c) {
                            const bool inDuct = c[1] > y && c[1] < y + d && c[2] > z && c[2] < z + d;
                            return c[0] < 1.01 || c[0] > 1.51 || inDuct ? 1 : 0;
                          });
  const PaintFrontReport report = look(soup);
  ASSERT_EQ(report.regions.size(), 3u);
  ASSERT_TRUE(report.regions[1].chosen);
  ASSERT_EQ(report.invisible.places.size(), 1u);
  const NarrowPlace& place = report.invisible.places[0];
  EXPECT_EQ(place.leadsTo, 2);
  EXPECT_NEAR(place.narrowest, d, 1e-9);
  EXPECT_NEAR(place.featureSize, d / 2, 1e-9);
  EXPECT_NEAR(place.centre[1], y + d / 2, 0.01);
  EXPECT_NEAR(place.centre[2], z + d / 2, 0.01);
  EXPECT_GT(place.bounds.size()[0], 0.3) << "of 0.5 between the rooms";
  PaintFrontOptions both;
  both.region = Region::Enclosed;
  const PaintFrontReport all = look(soup, both);
  ASSERT_EQ(all.invisible.places.size(), 1u);
  EXPECT_EQ(all.invisible.places[0].leadsTo, kNone) << "both rooms are in the mesh";
  PaintFrontOptions off;
  off.reportInvisible = false;
  EXPECT_TRUE(look(soup, off).invisible.places.empty());
}

TEST(NarrowPassages, ThePromisedFeatureSizeShowsTheSlot) {
  const Soup soup = slot(1.5 * kSize, 0.3);
  const PaintFrontReport report = look(soup);
  ASSERT_EQ(report.invisible.places.size(), 1u);
  const auto model = soup.model();
  OctreeDecomposeOptions o;
  o.featureSize = report.invisible.places[0].featureSize;
  Monitor monitor;
  PaintFrontReport finer;
  paintFront(decompose(*model, o, monitor), *model, {}, monitor, &finer);
  EXPECT_TRUE(finer.invisible.places.empty());
}

TEST(NarrowPassages, SameOnAnyNumberOfThreads) {
  std::vector<PaintFrontReport> reports;
  for (int threads : {1, 2, 4})
    withThreads(threads, [&] { reports.push_back(look(slot(0.5 * kSize, 0.3))); });
  for (const PaintFrontReport& r : reports) {
    ASSERT_EQ(r.invisible.cells.size(), reports[0].invisible.cells.size());
    for (std::size_t i = 0; i < r.invisible.cells.size(); ++i)
      EXPECT_EQ(r.invisible.cells[i].point, reports[0].invisible.cells[i].point);
  }
}

}  // namespace
