// SPDX-License-Identifier: BSD-3-Clause
// Polygons cut into parts that hold their triangles about their centre.
#include "StarPolygons.h"

#include <gtest/gtest.h>

#include <numeric>

namespace {

using namespace pm;

double areaOf(const std::vector<Vec2>& points, const std::vector<Id>& row) {
  double twice = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Vec2 &a = points[row[i]], &b = points[row[(i + 1) % row.size()]];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

std::vector<std::vector<Id>> cut(const std::vector<Vec2>& points) {
  std::vector<Id> row(points.size());
  std::iota(row.begin(), row.end(), Id(0));
  const auto parts = cutIntoStars(points, {row.data(), row.data() + row.size()});
  if (parts.empty()) return parts;
  double sum = 0;
  for (const std::vector<Id>& part : parts) {
    EXPECT_TRUE(isStar(points, {part.data(), part.data() + part.size()}));
    EXPECT_GT(areaOf(points, part), 0);
    sum += areaOf(points, part);
  }
  EXPECT_NEAR(sum, areaOf(points, row), 1e-12);
  return parts;
}

TEST(StarPolygons, GoodOnesStayWhole) {
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {0, 1}}).size(), 1u);
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 1}}).size(), 1u);  // a point hangs on an edge
  EXPECT_EQ(cut({{0, 0}, {4, 0}, {4, 4}, {2, 3}, {0, 4}}).size(), 1u);  // a dent
}

TEST(StarPolygons, HollowOnesAreCut) {
  EXPECT_EQ(cut({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}).size(), 2u);               // L
  const auto parts = cut({{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}});  // U
  EXPECT_TRUE(parts.size() == 3 || parts.size() == 4) << parts.size();
  EXPECT_GT(cut({{0, 0}, {9, 0}, {9, 3}, {8, 1}, {6, 1}, {6, 3}, {5, 3}, {5, 1}, {0, 1}}).size(),
            2u);  // comb
}

TEST(StarPolygons, InsideOutIsRefused) {
  EXPECT_TRUE(cut({{0, 0}, {0, 1}, {1, 1}, {1, 0}}).empty());
  EXPECT_TRUE(cut({{0, 0}, {1, 0}, {2, 0}}).empty());  // no area
}

}  // namespace
