// SPDX-License-Identifier: BSD-3-Clause
// Sections of small meshes have the area of the exact section, and polygons of neighbours share their sides,
// wherever the plane lies.
#include "MeshSlice.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "TestMeshes.h"

namespace pm {
namespace {

using testing::CellFaces;
using testing::Face;
using testing::layeredVoxels;
using testing::VoxelOptions;

constexpr double kTolerance = 1e-12;

/// Cells that need not be a mesh: rows of faces, each face of its own.
struct Cells {
  std::vector<Vec3> points;
  Csr<Id> faces, cells;

  void add(const CellFaces& cell) {
    std::vector<Id> row;
    for (const Face& face : cell) {
      row.push_back(faces.rows());
      faces.push(face);
    }
    cells.push(row);
  }
};

Cells cellsOf(const PolyMesh& mesh) { return {mesh.points, mesh.faces, cellFaces(mesh)}; }

struct Cut {
  PlaneSection section;
  std::vector<Vec3> points;
  std::vector<double> areas;  // of polygons, by their outline: positive when counter-clockwise
  double area() const { return std::accumulate(areas.begin(), areas.end(), 0.0); }
};

Cut cut(const Cells& m, const SlicePlane& plane) {
  std::vector<double> distance;
  for (const Vec3& p : m.points) distance.push_back(plane.distance(p, kTolerance));
  Monitor monitor;
  Cut result;
  result.section = sliceCells(
      m.faces, m.cells, distance, [&](Id p) { return m.points[p]; }, plane, monitor);
  for (const EdgeCrossing& c : result.section.points) {
    result.points.push_back((1 - c.part) * m.points[c.low] + c.part * m.points[c.high]);
  }
  for (Id i = 0; i < result.section.polygons.rows(); ++i) {
    const Span<Id> row = result.section.polygons[i];
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < row.size(); ++k) {
      sum += (result.points[row[k]] - plane.origin)
                 .cross(result.points[row[(k + 1) % row.size()]] - plane.origin);
    }
    result.areas.push_back(0.5 * sum.dot(plane.normal));
  }
  return result;
}

SlicePlane planeAt(const Vec3& origin, const Vec3& normal) { return {origin, normal.normalized()}; }

/// Area of a plane's part in a box: a large square in the plane, clipped by the box's sides one after
/// another.
double areaInBox(const Box& box, const SlicePlane& plane) {
  const Vec3 other = std::abs(plane.normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 u = 100 * plane.normal.cross(other).normalized(), v = plane.normal.cross(u);
  std::vector<Vec3> polygon{plane.origin - u - v, plane.origin + u - v, plane.origin + u + v,
                            plane.origin - u + v};
  for (int side = 0; side < 6; ++side) {
    const int a = side / 2;
    const auto inside = [&](const Vec3& p) { return side % 2 ? box.hi[a] - p[a] : p[a] - box.lo[a]; };
    std::vector<Vec3> clipped;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double dp = inside(p), dq = inside(q);
      if (dp >= 0) clipped.push_back(p);
      if ((dp >= 0) != (dq >= 0)) clipped.push_back(p + dp / (dp - dq) * (q - p));
    }
    polygon = clipped;
  }
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) sum += polygon[i].cross(polygon[(i + 1) % polygon.size()]);
  return 0.5 * sum.dot(plane.normal);
}

/// Sides of polygons that have no opposite side in another polygon; a side twice the same way counts as such.
Id freeSides(const PlaneSection& section) {
  std::map<std::pair<Id, Id>, int> uses;
  for (Id i = 0; i < section.polygons.rows(); ++i) {
    const Span<Id> row = section.polygons[i];
    for (std::size_t k = 0; k < row.size(); ++k) ++uses[{row[k], row[(k + 1) % row.size()]}];
  }
  Id free = 0;
  for (const auto& [side, count] : uses) {
    const auto back = uses.find({side.second, side.first});
    if (count != 1 || back == uses.end() || back->second != 1) free += count;
  }
  return free;
}

/// A block from 0 to 4 whose inner points are moved at random: faces are warped, and the block stays one.
PolyMesh shakenBlock(double by, unsigned seed = 1) {
  VoxelOptions o;
  o.size = {4, 4, 4};
  o.wallSide.fill(false);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-by, by);
  o.deform = [&](const Vec3& p) {
    Vec3 q = p;
    for (int a = 0; a < 3; ++a) {
      if (p[a] > 0 && p[a] < 4) q[a] += uniform(random);
    }
    return q;
  };
  return layeredVoxels(o);
}

const Box kBlock{Vec3::Zero(), Vec3::Constant(4)};

TEST(MeshSlice, PlanesOfTheGridAndOthersHaveTheExactArea) {
  const Cells block = cellsOf(shakenBlock(0));
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(1, -1, 0), Vec3(1, 1, 1),
                             Vec3(1, 2, 3), Vec3(-3, 1, 0.2)}) {
    for (const double at : {0.5, 1.0, 1.7, 2.0, 3.0, 3.999}) {
      const SlicePlane plane = planeAt(Vec3::Constant(at), normal);
      const Cut c = cut(block, plane);
      EXPECT_NEAR(c.area(), areaInBox(kBlock, plane), 1e-9) << normal.transpose() << " at " << at;
      EXPECT_GT(*std::min_element(c.areas.begin(), c.areas.end()), 0) << normal.transpose() << " at " << at;
    }
  }
}

TEST(MeshSlice, APlaneOfTheGridHasOneSquareForEachCellBelowIt) {
  const Cut c = cut(cellsOf(shakenBlock(0)), planeAt({0, 0, 2}, Vec3::UnitZ()));
  ASSERT_EQ(c.section.polygons.rows(), 16);
  for (Id i = 0; i < 16; ++i) {
    EXPECT_EQ(c.section.polygons[i].size(), 4u);
    EXPECT_NEAR(c.areas[i], 1, 1e-12);
  }
  EXPECT_EQ(c.points.size(), 25u);
  for (const EdgeCrossing& p : c.section.points) EXPECT_EQ(p.low, p.high);
}

TEST(MeshSlice, WarpedFacesLeaveNoHoles) {
  std::mt19937 random(7);
  std::normal_distribution<double> gauss;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const PolyMesh mesh = shakenBlock(0.3, seed);
    const Cells block = cellsOf(mesh);
    const SlicePlane plane = planeAt({2.1, 1.9, 2.05}, {gauss(random), gauss(random), gauss(random)});
    const Cut c = cut(block, plane);
    EXPECT_NEAR(c.area(), areaInBox(kBlock, plane), 1e-9) << seed;
    const Cut through = cut(block, planeAt(mesh.points[62], plane.normal));  // an inner point
    EXPECT_NEAR(through.area(), areaInBox(kBlock, planeAt(mesh.points[62], plane.normal)), 1e-9) << seed;
  }
}

TEST(MeshSlice, ASideInThePlaneIsShownWhicheverWayThePlaneLooks) {
  const Cells block = cellsOf(shakenBlock(0.3));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {0.0, 4.0}) {
      for (const double sign : {-1.0, 1.0}) {
        const Cut c = cut(block, planeAt(Vec3::Constant(at), sign * Vec3::Unit(axis)));
        EXPECT_EQ(c.section.polygons.rows(), 16);
        EXPECT_NEAR(c.area(), 16, 1e-9);
        EXPECT_EQ(freeSides(c.section), 16);  // the outline
      }
    }
  }
}

TEST(MeshSlice, AStepIsCoveredOnceFromEitherSide) {
  VoxelOptions o;
  o.size = {4, 4, 4};
  o.wallSide.fill(false);
  o.occupied = [](int i, int, int k) { return k < 2 || i < 2; };
  o.deform = [](const Vec3& p) { return p; };
  PolyMesh mesh = layeredVoxels(o);
  const Cells cells = cellsOf(mesh);
  for (const double sign : {-1.0, 1.0}) {
    const Cut c = cut(cells, planeAt({0, 0, 1}, sign * Vec3::UnitZ()));
    EXPECT_NEAR(c.area(), 16, 1e-9);
    const Cut upper = cut(cells, planeAt({0, 0, 2}, sign * Vec3::UnitZ()));
    EXPECT_NEAR(upper.area(), 16, 1e-9);
    EXPECT_EQ(freeSides(upper.section), 16);
  }
}

/// Corners of a box as two faces for prism(): bottom and top.
std::pair<Face, Face> addBox(Cells& cells, const Vec3& lo, const Vec3& hi) {
  const Id first = static_cast<Id>(cells.points.size());
  for (const double z : {lo.z(), hi.z()}) {
    for (const auto& [x, y] :
         {std::pair(lo.x(), lo.y()), {hi.x(), lo.y()}, {hi.x(), hi.y()}, {lo.x(), hi.y()}})
      cells.points.push_back({x, y, z});
  }
  return {{first, first + 1, first + 2, first + 3}, {first + 4, first + 5, first + 6, first + 7}};
}

TEST(MeshSlice, CellsOfTwoSizesThatShareNoFaceAreCoveredOnce) {
  Cells cells;  // a large cube and four small ones on it, as octree leaves before their faces are split
  const auto [bottom, top] = addBox(cells, {0, 0, -2}, {2, 2, 0});
  cells.add(testing::prism(bottom, top));
  for (const int k : {0, 1, 2, 3}) {
    const Vec3 lo(k % 2, k / 2, 0);
    const auto [low, high] = addBox(cells, lo, lo + Vec3::Ones());
    cells.add(testing::prism(low, high));
  }
  EXPECT_EQ(cut(cells, planeAt(Vec3::Zero(), Vec3::UnitZ())).section.polygons.rows(), 1);
  EXPECT_EQ(cut(cells, planeAt(Vec3::Zero(), -Vec3::UnitZ())).section.polygons.rows(), 4);
  EXPECT_NEAR(cut(cells, planeAt(Vec3::Zero(), Vec3::UnitZ())).area(), 4, 1e-12);
  EXPECT_NEAR(cut(cells, planeAt(Vec3::Zero(), -Vec3::UnitZ())).area(), 4, 1e-12);
}

/// Two cells in a column of section 1, between them a face whose corners are up and down in turn.
Cells saddle() {
  Cells cells;
  const auto [bottom, middle] = addBox(cells, {0, 0, -1}, {1, 1, 0});
  const auto [unused, top] = addBox(cells, {0, 0, 0}, {1, 1, 1});
  for (std::size_t i = 0; i < 4; ++i) cells.points[middle[i]].z() = i % 2 ? -0.2 : 0.2;
  cells.add(testing::prism(bottom, middle));
  cells.add(testing::prism(middle, top));
  return cells;
}

TEST(MeshSlice, AFaceCrossedFourTimesIsCutTheSameWayForBothItsCells) {
  const Cells cells = saddle();
  for (const double z : {-0.15, -0.05, 0.0, 0.05, 0.15}) {
    for (const double sign : {-1.0, 1.0}) {
      const Cut c = cut(cells, planeAt({0, 0, z}, sign * Vec3::UnitZ()));
      EXPECT_EQ(c.section.polygons.rows(), 3) << z;  // one cell in two corners, the other in between
      EXPECT_NEAR(c.area(), 1, 1e-12) << z;
      EXPECT_GT(*std::min_element(c.areas.begin(), c.areas.end()), 0) << z;
    }
  }
}

TEST(MeshSlice, TheWayFacesRunDoesNotMatter) {
  Cells cells = cellsOf(shakenBlock(0.3));
  const SlicePlane plane = planeAt({2, 2, 2}, {1, 2, 3});
  const double area = cut(cells, plane).area();
  for (Id f = 0; f < cells.faces.rows(); f += 7) {
    std::reverse(cells.faces.values.begin() + cells.faces.offsets[f],
                 cells.faces.values.begin() + cells.faces.offsets[f + 1]);
  }
  const Cut c = cut(cells, plane);
  const double sum = std::accumulate(c.areas.begin(), c.areas.end(), 0.0,
                                     [](double s, double a) { return s + std::abs(a); });
  EXPECT_NEAR(sum, area, 1e-9);
}

TEST(MeshSlice, NothingForCellsThatThePlaneOnlyGrazes) {
  Cells cells;
  const auto [bottom, top] = addBox(cells, {0, 0, 0}, {1, 1, 1});
  cells.add(testing::prism(bottom, top));
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(cut(cells, planeAt({0, 0, 0}, sign * Vec3(1, 1, 1))).section.polygons.rows(), 0);  // a corner
    EXPECT_EQ(cut(cells, planeAt({0, 0, 0}, sign * Vec3(1, 1, 0))).section.polygons.rows(), 0);  // an edge
    EXPECT_EQ(cut(cells, planeAt({0, 0, 5}, sign * Vec3(0, 0, 1))).section.polygons.rows(), 0);
  }
}

TEST(MeshSlice, PointsInThePlaneOnASideStayInThePolygon) {
  // A cell with an extra point on the edge of its top, where a smaller neighbour ends, and one beside that
  // edge.
  Cells cells;
  const auto [bottom, top] = addBox(cells, {0, 0, -1}, {1, 1, 0});
  cells.points.push_back({0.5, -0.1, 0});
  const Id extra = static_cast<Id>(cells.points.size()) - 1;
  CellFaces cell = testing::prism(bottom, top);
  for (Face& face : cell) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Id a = face[i], b = face[(i + 1) % face.size()];
      if (std::minmax(a, b) == std::minmax(top[0], top[1])) {
        face.insert(face.begin() + i + 1, extra);
        break;
      }
    }
  }
  cells.add(cell);
  const Cut c = cut(cells, planeAt(Vec3::Zero(), Vec3::UnitZ()));
  ASSERT_EQ(c.section.polygons.rows(), 1);
  EXPECT_EQ(c.section.polygons[0].size(), 5u);
  EXPECT_NEAR(c.area(), 1.05, 1e-12);
}

TEST(MeshSlice, ACellWithAStepInThePlaneIsNotCutAlongTheStep) {
  // An L of height 2 and a cube that fills it up to a block; the step's face is the cube's top.
  Cells cells;
  const std::vector<std::pair<double, double>> outline{{0, 0}, {1, 0}, {1, -1}, {2, -1},
                                                       {2, 1}, {0, 1}, {0, -1}};
  for (const double y : {1.0, 0.0}) {
    for (const auto& [x, z] : outline) cells.points.push_back({x, y, z});
  }
  cells.add(testing::prism({0, 1, 2, 3, 4, 5}, {7, 8, 9, 10, 11, 12}));
  cells.add(testing::prism({0, 6, 2, 1}, {7, 13, 9, 8}));
  const Cut above = cut(cells, planeAt(Vec3::Zero(), Vec3::UnitZ()));
  ASSERT_EQ(above.section.polygons.rows(), 2);
  EXPECT_NEAR(above.areas[0], 1, 1e-12);
  EXPECT_NEAR(above.areas[1], 1, 1e-12);
  EXPECT_EQ(freeSides(above.section), 6);
  const Cut below = cut(cells, planeAt(Vec3::Zero(), -Vec3::UnitZ()));
  ASSERT_EQ(below.section.polygons.rows(), 1);
  EXPECT_EQ(below.section.cell[0], 0);
  EXPECT_NEAR(below.areas[0], 2, 1e-12);
}

TEST(MeshSlice, AnOpenCellGivesWhatThereIs) {
  Cells cells;
  const auto [bottom, top] = addBox(cells, {0, 0, 0}, {1, 1, 1});
  CellFaces cell = testing::prism(bottom, top);
  cell.pop_back();  // a side: the others are joined straight across
  cells.add(cell);
  const Cut c = cut(cells, planeAt({0, 0, 0.5}, Vec3::UnitZ()));
  ASSERT_EQ(c.section.polygons.rows(), 1);
  EXPECT_NEAR(c.area(), 1, 1e-12);
}

TEST(MeshSlice, SameBitsForAnyNumberOfThreads) {
  VoxelOptions o;
  o.size = {14, 14, 14};  // several blocks of cells
  const Cells cells = cellsOf(layeredVoxels(o));
  for (const SlicePlane& plane : {planeAt({7, 7, 7.3}, {1, 2, 9}), planeAt({0, 0, 0}, Vec3::UnitZ())}) {
    std::vector<Cut> cuts;
    for (const std::size_t threads : {1, 3}) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      cuts.push_back(cut(cells, plane));
    }
    EXPECT_EQ(cuts[0].section.polygons.offsets, cuts[1].section.polygons.offsets);
    EXPECT_EQ(cuts[0].section.polygons.values, cuts[1].section.polygons.values);
    EXPECT_EQ(cuts[0].section.cell, cuts[1].section.cell);
    EXPECT_EQ(cuts[0].points, cuts[1].points);
  }
}

TEST(MeshSlice, StopsOnRequest) {
  struct Stopped : Monitor {
    bool aborted() const override { return true; }
  } stopped;
  EXPECT_THROW(sliceCells({}, {}, {}, {}, {}, stopped), AbortError);
}

}  // namespace
}  // namespace pm
