// SPDX-License-Identifier: BSD-3-Clause
// How narrow a gap criteria 3 and 4 still separate: plates of any slope, concentric spheres, and the gap
// between a valve and its seat, at gap widths of a few finest cells. The table of Docs/OctreeDecompose.md
// comes from here.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "OctreeDecompose.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kCell = 0.01;  // finest cell

/// Lines across a gap, from wall to wall.
struct Gap {
  std::unique_ptr<SurfaceModel> model;
  std::function<std::pair<Vec3, Vec3>(std::mt19937_64&)> line;
};

struct Found {
  int lines = 0;
  int open = 0;    ///< lines that meet a free cell
  int coarse = 0;  ///< lines without one, though a cell on them could be split further
  int level = 0;   ///< deepest
  Id leaves = 0;
};

Found study(const Gap& gap, OctreeDecomposeOptions o) {
  o.featureSize = kCell;
  o.baseSize = 16 * kCell;
  o.normalAngle = 0;
  o.refineEdges = false;
  Monitor monitor;
  const Octree tree = decompose(*gap.model, o, monitor);
  Found found;
  found.leaves = tree.size();
  std::mt19937_64 generator(7);
  for (; found.lines < 400; ++found.lines) {
    const auto [a, b] = gap.line(generator);
    bool free = false, coarse = false;
    for (int i = 1; i < 64; ++i) {
      const Id leaf = tree.locate(a + i / 64.0 * (b - a));
      free = free || !tree.cut[leaf];
      coarse = coarse || tree.levels[leaf] < tree.brick.maxLevel;
      found.level = std::max<int>(found.level, tree.levels[leaf]);
    }
    found.open += free;
    found.coarse += !free && coarse;
  }
  return found;
}

Gap platesAt(double gap, const Vec3& normal) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
  // An offset that is no multiple of the cell.
  const Vec3 shift(0.00137, 0.00271, 0.00314);
  Soup s;
  for (double z : {0.0, gap}) s.addGrid(Vec3(0, 0, z), Vec3(0.6, 0, 0), Vec3(0, 0.6, 0), 1);
  const auto place = [=](const Vec3& p) { return Vec3(turn * p + shift); };
  return {s.mapped(place).model(), [=](std::mt19937_64& generator) {
            Vec3 p = randomPoint(generator, 0.1, 0.5);
            p[2] = 0;
            return std::make_pair(place(p), place(p + gap * Vec3::UnitZ()));
          }};
}

Gap spheresAt(double gap) {
  const double radius = 0.3;
  Soup s;
  for (double r : {radius, radius + gap})
    s.append(cube(24).mapped([=](const Vec3& p) { return Vec3(r * (2 * p - Vec3::Ones()).normalized()); }));
  return {s.model(), [=](std::mt19937_64& generator) {
            const Vec3 n = randomPoint(generator, -1, 1).normalized();
            return std::make_pair(Vec3(radius * n), Vec3((radius + gap) * n));
          }};
}

/// A port with a conical seat at 45 degrees and a valve head with a cone parallel to it.
Gap valveAt(double gap) {
  const int facets = 72;
  Soup s;
  const auto ring = [&](double r0, double z0, double r1, double z1) {
    for (int i = 0; i < facets; ++i) {
      const auto at = [&](double r, double z, int k) {
        const double a = 2 * 3.14159265358979323846 * k / facets;
        return Vec3(r * std::cos(a), r * std::sin(a), z);
      };
      s.add(at(r0, z0, i), at(r0, z0, i + 1), at(r1, z1, i + 1));
      s.add(at(r0, z0, i), at(r1, z1, i + 1), at(r1, z1, i));
    }
  };
  const double lift = gap * std::sqrt(2.0);
  ring(0.25, 0.5, 0.25, 0.1);         // port
  ring(0.25, 0.1, 0.35, 0.0);         // seat
  ring(0.35, 0.0, 0.6, 0.0);          // head of the cylinder
  ring(0.05, 0.5, 0.05, 0.1 - lift);  // stem
  ring(0.05, 0.1 - lift, 0.25, 0.1 - lift);
  ring(0.25, 0.1 - lift, 0.35, -lift);  // cone of the valve
  ring(0.35, -lift, 0.0, -lift);        // its face
  return {s.model(), [=](std::mt19937_64& generator) {
            const Vec3 u = randomPoint(generator);
            const double a = 2 * 3.14159265358979323846 * u[0], t = 0.2 + 0.6 * u[1];
            const double r = 0.25 + 0.1 * t, z = 0.1 - 0.1 * t, c = std::cos(3.14159265358979323846 / facets);
            const Vec3 out(std::cos(a), std::sin(a), 0),
                half = 0.5 * gap * std::sqrt(2.0) * (out + Vec3::UnitZ()) / 2;
            const Vec3 middle = 0.5 * (1 + c) * r * out + Vec3(0, 0, z - 0.5 * lift);
            return std::make_pair(Vec3(middle - 0.95 * half), Vec3(middle + 0.95 * half));
          }};
}

const std::vector<Vec3> kSlopes = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 2, 4}, {0, 1, 10}};

/// What holds at any gap that the finest cells can tell apart, whatever the shape.
void expectSeparated(const Gap& gap, double cells) {
  const Found found = study(gap, {});
  EXPECT_EQ(found.level, cells >= 8 ? 3 : 4) << "gap of " << cells << " cells";
  EXPECT_EQ(found.coarse, 0) << "gap of " << cells << " cells";
  // |nx| + |ny| + |nz| + max |nk| is at most 2.31: from there on a free cell lies on every line.
  if (cells >= 3) EXPECT_EQ(found.open, found.lines) << "gap of " << cells << " cells";
  if (cells == 2.5) EXPECT_GT(found.open, 0.99 * found.lines);
  if (cells <= 1) EXPECT_EQ(found.open, 0);
}

TEST(Separation, PlatesOfAnySlope) {
  for (double cells : {8., 4., 3., 2.5, 2., 1.5, 1.25, 1.})
    for (const Vec3& slope : kSlopes) {
      SCOPED_TRACE(::testing::Message() << "normal " << slope.transpose());
      expectSeparated(platesAt(cells * kCell, slope.normalized()), cells);
    }
}

TEST(Separation, ConcentricSpheres) {
  for (double cells : {4., 3., 2.5, 2., 1.5, 1.}) expectSeparated(spheresAt(cells * kCell), cells);
}

TEST(Separation, ValveAndSeat) {
  for (double cells : {4., 3., 2.5, 2., 1.5, 1.}) expectSeparated(valveAt(cells * kCell), cells);
}

TEST(Separation, CostsCellsOnlyWhereTheGapIs) {
  const Gap gap = platesAt(2.5 * kCell, Vec3(1, 2, 4).normalized());
  OctreeDecomposeOptions off;
  off.separate = false;
  const Found without = study(gap, off);
  EXPECT_EQ(without.level, 0);
  EXPECT_EQ(without.open, 0);
  // Two plates of 60 by 60 cells: twice 3,600 cut ones and as many between and beside them, a few times over.
  EXPECT_LT(study(gap, {}).leaves, 16 * 3600);
}

TEST(Separation, SurfacesWithinHalfACellAreOneWall) {
  for (const Vec3& slope : kSlopes)
    EXPECT_EQ(study(platesAt(0.25 * kCell, slope.normalized()), {}).level, 0) << slope.transpose();
}

}  // namespace
