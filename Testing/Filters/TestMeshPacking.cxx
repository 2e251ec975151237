// SPDX-License-Identifier: BSD-3-Clause
// Meshes and octrees through VTK grids and back.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "MeshPacking.h"
#include "OctreePacking.h"
#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace {

using Row = std::vector<pm::Id>;
using CellRows = std::vector<Row>;  // outward faces

/// A canonical mesh of cells given by their outward faces.
pm::PolyMesh meshOf(std::vector<pm::Vec3> points, const std::vector<CellRows>& cells) {
  struct Side {
    pm::Id cell;
    Row row;
  };
  std::map<Row, std::vector<Side>> sides;  // by sorted points
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const Row& row : cells[cell]) {
      Row key = row;
      std::sort(key.begin(), key.end());
      sides[key].push_back({static_cast<pm::Id>(cell), row});
    }
  }
  pm::PolyMesh mesh;
  for (const bool internal : {true, false}) {
    for (const auto& [key, both] : sides) {
      if ((both.size() == 2) != internal) continue;
      mesh.faces.push(both[0].row);
      mesh.owner.push_back(both[0].cell);
      if (internal) mesh.neighbour.push_back(both[1].cell);
      if (!internal) mesh.patch.push_back(static_cast<pm::Id>(mesh.patch.size() % 2));
    }
  }
  mesh.points = std::move(points);
  mesh.cellCount = static_cast<pm::Id>(cells.size());
  mesh.patchNames = {"wall", "xmin"};
  mesh.patchTypes = {"wall", "patch"};
  mesh.level.assign(cells.size(), 3);
  mesh.layer.assign(cells.size(), 1);
  mesh.fixed.assign(mesh.points.size(), 2);
  mesh.base.assign(mesh.points.size(), pm::kNone);
  mesh.finestSize = 0.1;
  mesh.stage = pm::Stage::Layer;
  pm::canonicalise(mesh);
  return mesh;
}

/// Unit cube, and above it an apex at (.5 .5 2).
std::vector<pm::Vec3> cubeAndApex() {
  return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},    {0, 0, 1},
          {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 2}};
}
const CellRows kCube = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
const CellRows kPyramid = {{7, 6, 5, 4}, {4, 5, 8}, {5, 6, 8}, {6, 7, 8}, {7, 4, 8}};
const CellRows kWedge = {{0, 2, 1}, {4, 5, 6}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 0, 4, 6}};
const CellRows kTetra = {{4, 6, 5}, {4, 5, 8}, {5, 6, 8}, {6, 4, 8}};
/// The cube with its lid cut in two triangles.
const CellRows kCutCube = {{0, 3, 2, 1}, {4, 5, 6},    {4, 6, 7},   {0, 1, 5, 4},
                           {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

void expectEqual(const pm::PolyMesh& a, const pm::PolyMesh& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.faces.offsets, b.faces.offsets);
  EXPECT_EQ(a.faces.values, b.faces.values);
  EXPECT_EQ(a.owner, b.owner);
  EXPECT_EQ(a.neighbour, b.neighbour);
  EXPECT_EQ(a.patch, b.patch);
  EXPECT_EQ(a.patchNames, b.patchNames);
  EXPECT_EQ(a.patchTypes, b.patchTypes);
  EXPECT_EQ(a.cellCount, b.cellCount);
  EXPECT_EQ(a.level, b.level);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.fixed, b.fixed);
  EXPECT_EQ(a.base, b.base);
  EXPECT_EQ(a.finestSize, b.finestSize);
  EXPECT_EQ(a.stage, b.stage);
}

/// VTK's own view of the cell: every face's normal leaves the cell.
void expectOutward(vtkCell* cell) {
  pm::Vec3 centre = pm::Vec3::Zero();
  for (int i = 0; i < cell->GetNumberOfPoints(); ++i) centre += pm::Vec3(cell->GetPoints()->GetPoint(i));
  centre /= static_cast<double>(cell->GetNumberOfPoints());
  for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
    vtkPoints* p = cell->GetFace(f)->GetPoints();
    const pm::Vec3 a(p->GetPoint(0)), b(p->GetPoint(1)), c(p->GetPoint(2));
    EXPECT_GT((b - a).cross(c - a).dot(a - centre), 0) << "face " << f;
  }
}

struct Shape {
  const char* name;
  CellRows faces;
  int vtkType;
};
void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

class Shapes : public testing::TestWithParam<Shape> {};

TEST_P(Shapes, KnownByVtk) {
  std::vector<pm::Vec3> points = cubeAndApex();
  const pm::PolyMesh mesh = meshOf(points, {GetParam().faces});
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  ASSERT_EQ(grid->GetNumberOfCells(), 1);
  EXPECT_EQ(grid->GetCellType(0), GetParam().vtkType);
  expectOutward(grid->GetCell(0));
  expectEqual(pm::unpackMesh(grid, "test", {}), mesh);
}

INSTANTIATE_TEST_SUITE_P(MeshPacking, Shapes,
                         testing::Values(Shape{"Hexahedron", kCube, VTK_HEXAHEDRON},
                                         Shape{"Pyramid", kPyramid, VTK_PYRAMID},
                                         Shape{"Wedge", kWedge, VTK_WEDGE},
                                         Shape{"Tetrahedron", kTetra, VTK_TETRA},
                                         Shape{"CutCube", kCutCube, VTK_POLYHEDRON}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(MeshPacking, CubeByAnyNumbering) {
  // The same cube with its points renamed in many ways keeps its faces.
  Row name = {0, 1, 2, 3, 4, 5, 6, 7};
  for (int round = 0; round < 200; ++round) {
    std::next_permutation(name.begin(), name.end());
    std::rotate(name.begin(), name.begin() + 3, name.end());
    const std::vector<pm::Vec3> corners = cubeAndApex();
    std::vector<pm::Vec3> points(8);
    for (int i = 0; i < 8; ++i) points[name[i]] = corners[i];
    CellRows cell = kCube;
    for (Row& row : cell) {
      for (pm::Id& p : row) p = name[p];
    }
    const pm::PolyMesh mesh = meshOf(points, {cell});
    vtkNew<vtkUnstructuredGrid> grid;
    pm::packMesh(mesh, grid);
    ASSERT_EQ(grid->GetCellType(0), VTK_HEXAHEDRON);
    expectEqual(pm::unpackMesh(grid, "test", {}), mesh);
  }
}

TEST(MeshPacking, SixQuadsOfAnotherShapeStayAPolyhedron) {
  // A cube with one of its edges turned: closed, six quads and eight points, but no hexahedron.
  // hexahedron.
  const CellRows turned = {{0, 1, 2, 3}, {1, 0, 4, 5}, {2, 1, 5, 6},
                           {0, 3, 2, 6}, {0, 6, 7, 4}, {5, 4, 7, 6}};
  const pm::PolyMesh mesh = meshOf(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {turned});
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  EXPECT_EQ(grid->GetCellType(0), VTK_POLYHEDRON);
  expectEqual(pm::unpackMesh(grid, "test", {}), mesh);
}

TEST(MeshPacking, NeighboursOfDifferentShape) {
  const pm::PolyMesh mesh = meshOf(cubeAndApex(), {kPyramid, kCube});
  ASSERT_EQ(mesh.internalFaces(), 1);
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  EXPECT_EQ(grid->GetCellType(0), VTK_PYRAMID);
  EXPECT_EQ(grid->GetCellType(1), VTK_HEXAHEDRON);
  expectEqual(pm::unpackMesh(grid, "test", {}), mesh);
}

TEST(MeshPacking, ThirtyTwoBitCellsAreReadToo) {
  const pm::PolyMesh mesh = meshOf(cubeAndApex(), {kPyramid, kCube});
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  grid->GetCells()->ConvertTo32BitStorage();
  expectEqual(pm::unpackMesh(grid, "test", {}), mesh);
  EXPECT_FALSE(grid->GetCells()->IsStorage64Bit()) << "the input was edited";
}

TEST(MeshPacking, BoundaryHoldsUsedPointsOnly) {
  std::vector<pm::Vec3> points = cubeAndApex();
  const pm::PolyMesh mesh = meshOf(points, {kPyramid, kCube});
  vtkNew<vtkPolyData> surface;
  pm::packBoundary(mesh, surface);
  EXPECT_EQ(surface->GetNumberOfCells(), 9);
  EXPECT_EQ(surface->GetNumberOfPoints(), 9);
  double bounds[6];
  surface->GetBounds(bounds);
  EXPECT_EQ(bounds[5], 2);
  EXPECT_TRUE(surface->GetCellData()->HasArray("PatchId"));
}

std::string refusal(vtkUnstructuredGrid* grid, std::initializer_list<pm::Stage> accepted = {}) {
  try {
    pm::unpackMesh(grid, "Project", accepted);
  } catch (const pm::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MeshPacking, ChangesAreRefused) {
  const pm::PolyMesh mesh = meshOf(cubeAndApex(), {kPyramid, kCube});
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  EXPECT_EQ(refusal(grid), "");
  EXPECT_NE(refusal(grid, {pm::Stage::Front}).find("needs the output of Paint Front"), std::string::npos);

  vtkNew<vtkUnstructuredGrid> moved;
  moved->DeepCopy(grid);
  moved->GetPoints()->SetPoint(0, 1e-300, 0, 0);
  EXPECT_NE(refusal(moved), "");

  vtkNew<vtkUnstructuredGrid> relabelled;
  relabelled->DeepCopy(grid);
  relabelled->GetCellData()->GetArray("Layer")->SetComponent(0, 0, 0);
  EXPECT_NE(refusal(relabelled), "");

  vtkNew<vtkUnstructuredGrid> unnamed;
  unnamed->DeepCopy(grid);
  unnamed->GetFieldData()->RemoveArray("PatchNames");
  EXPECT_NE(refusal(unnamed), "");

  vtkNew<vtkUnstructuredGrid> foreign;
  foreign->DeepCopy(grid);
  foreign->GetFieldData()->Initialize();
  EXPECT_NE(refusal(foreign).find("carries no stamp"), std::string::npos);
}

TEST(MeshPacking, DamagedCellsAreRefused) {
  const pm::PolyMesh mesh = meshOf(cubeAndApex(), {kCutCube});
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packMesh(mesh, grid);
  for (vtkIdType at = 0; at < grid->GetFaces()->GetNumberOfValues(); ++at) {
    for (const vtkIdType bad : {vtkIdType(-1), vtkIdType(0), vtkIdType(1000000), VTK_ID_MAX}) {
      vtkNew<vtkUnstructuredGrid> damaged;
      damaged->DeepCopy(grid);
      if (damaged->GetFaces()->GetValue(at) == bad) continue;
      damaged->GetFaces()->SetValue(at, bad);
      EXPECT_NE(refusal(damaged), "") << "value " << at << " = " << bad;
    }
  }
}

/// One root cell of eight leaves, the first of them of eight again.
pm::Octree smallOctree() {
  pm::Octree tree;
  tree.brick.origin = {0.1, -3, 7};
  tree.brick.rootSize = {1, 1.01, 0.99};
  tree.brick.maxLevel = 2;
  tree.brick.sidesArePatches = true;
  for (int i = 0; i < 8; ++i) {
    tree.keys.push_back(pm::encode({i & 1, i >> 1 & 1, i >> 2 & 1}));
    tree.levels.push_back(2);
  }
  for (int i = 1; i < 8; ++i) {
    tree.keys.push_back(pm::encode({2 * (i & 1), 2 * (i >> 1 & 1), 2 * (i >> 2 & 1)}));
    tree.levels.push_back(1);
  }
  tree.cut.assign(tree.keys.size(), 0);
  tree.cut[3] = 1;
  tree.triangles.offsets.assign(tree.keys.size() + 1, 0);
  tree.index();
  return tree;
}

TEST(OctreePacking, RoundTrip) {
  const pm::Octree tree = smallOctree();
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packOctree(tree, grid);
  EXPECT_EQ(grid->GetNumberOfCells(), 15);
  EXPECT_EQ(grid->GetNumberOfPoints(), 27 + 19);  // 3^3 of the coarse grid, 3^3 of the fine one, 8 shared
  const pm::Octree back = pm::unpackOctree(grid, "test");
  EXPECT_EQ(back.keys, tree.keys);
  EXPECT_EQ(back.levels, tree.levels);
  EXPECT_EQ(back.cut, tree.cut);
  EXPECT_EQ(back.brick.origin, tree.brick.origin);
  EXPECT_EQ(back.brick.rootSize, tree.brick.rootSize);
  EXPECT_EQ(back.brick.roots, tree.brick.roots);
  EXPECT_EQ(back.brick.maxLevel, tree.brick.maxLevel);
  EXPECT_TRUE(back.brick.sidesArePatches);
  EXPECT_EQ(back.find({3, 3, 3}), 14);
}

TEST(OctreePacking, VoxelsAreTheLeaves) {
  const pm::Octree tree = smallOctree();
  vtkNew<vtkUnstructuredGrid> grid;
  pm::packOctree(tree, grid);
  for (pm::Id leaf = 0; leaf < tree.size(); ++leaf) {
    double bounds[6];
    grid->GetCellBounds(leaf, bounds);
    const pm::Box box = tree.box(leaf);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(bounds[2 * axis], box.lo[axis]);
      EXPECT_EQ(bounds[2 * axis + 1], box.hi[axis]);
    }
  }
}

}  // namespace
