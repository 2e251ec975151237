// SPDX-License-Identifier: BSD-3-Clause
#include "MeshQuality.h"

#include <gtest/gtest.h>

#include <cmath>

#include "TestMeshes.h"

namespace pm {
namespace {

using testing::CellFaces;
using testing::joinCells;
using testing::prism;

const double kPi = std::acos(-1.0);

PolyMesh hexes(const std::vector<Vec3>& points, int count) {
  // Points 4i .. 4i+3 are the i-th square of a row of hexahedra.
  std::vector<CellFaces> cells;
  for (Id i = 0; i < count; ++i) {
    const Id p = 4 * i;
    cells.push_back(prism({p, p + 1, p + 2, p + 3}, {p + 4, p + 5, p + 6, p + 7}));
  }
  return joinCells(points, cells, {"outside"}, {"patch"}, [](const testing::Face&) { return 0; });
}

/// Unit squares at heights 0, 1, .. , the i-th shifted by shifts[i] along x.
PolyMesh stack(const std::vector<double>& shifts) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const double x = shifts[i], z = static_cast<double>(i);
    for (const Vec3& p : {Vec3(x, 0, z), Vec3(x + 1, 0, z), Vec3(x + 1, 1, z), Vec3(x, 1, z)})
      points.push_back(p);
  }
  return hexes(points, static_cast<int>(shifts.size()) - 1);
}

Id faceWithin(const PolyMesh& mesh, double z) {
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    bool all = true;
    for (Id p : mesh.faces[f]) all = all && mesh.points[p].z() == z;
    if (all) return f;
  }
  return kNone;
}

TEST(MeshQuality, UnitCube) {
  const PolyMesh mesh = stack({0, 0});
  const MeshMeasures m = measure(mesh);
  EXPECT_NEAR(m.cells[0].volume, 1, 1e-14);
  EXPECT_NEAR((m.cells[0].centre - Vec3(0.5, 0.5, 0.5)).norm(), 0, 1e-14);
  EXPECT_NEAR(m.cells[0].minTet, 1.0 / 24, 1e-14);  // 6 faces of 4 equal tetrahedra
  const double eta = 2 * std::sqrt(3.0) * 0.25 / (0.5 * (1 + std::sqrt(2.0)));
  for (Id f = 0; f < 6; ++f) {
    EXPECT_NEAR(m.faces[f].normal.norm(), 1, 1e-14);
    EXPECT_NEAR(m.faces[f].normal.dot(m.faces[f].centre - m.cells[0].centre), 0.5, 1e-14);  // leaves the cell
    EXPECT_NEAR(m.faces[f].eta, eta, 1e-14);
    EXPECT_NEAR(m.faces[f].warpage(), 0, 1e-6);
    EXPECT_NEAR(m.faceAngle[f], 0, 1e-5);
    EXPECT_NEAR(m.faceSkew[f], 0, 1e-6);
  }
  const QualitySummary q = summarise(mesh, m, QualityLimits());
  EXPECT_NEAR(q.totalVolume, 1, 1e-14);
  EXPECT_NEAR(q.minEtaBoundary, eta, 1e-14);
  EXPECT_LT(q.maxOpenness, 1e-15);
  EXPECT_EQ(q.violations, 0);
  EXPECT_EQ(describeViolations(mesh, m, QualityLimits()), "");
}

TEST(MeshQuality, EquilateralTriangleIsNotDegraded) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(3.0) / 2, 0}};
  const std::vector<Id> row{0, 1, 2};
  const FaceMeasures m = measureFace(points, {row.data(), row.data() + 3});
  EXPECT_NEAR((m.centre - Vec3(0.5, std::sqrt(3.0) / 6, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR(m.normal.z(), std::sqrt(3.0) / 4, 1e-15);
  // Central triangles have sides 1, 1/sqrt(3), 1/sqrt(3).
  EXPECT_NEAR(m.eta, 2 * std::sqrt(3.0) * (std::sqrt(3.0) / 12) / (0.5 + 1 / std::sqrt(3.0)), 1e-14);
  EXPECT_EQ(m.warpage(), 0);
}

TEST(MeshQuality, FaceCentreIsWeightedByArea) {
  // A square with a point in the middle of an edge: the mean of the points is off centre, the centre is not.
  const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {0, 2, 0}};
  const std::vector<Id> row{0, 1, 2, 3, 4};
  const FaceMeasures m = measureFace(points, {row.data(), row.data() + 5});
  EXPECT_NEAR((m.centre - Vec3(1, 1, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((m.normal - Vec3(0, 0, 4)).norm(), 0, 1e-14);
  const FaceMeasures quick = measureFace(points, {row.data(), row.data() + 5}, true);
  EXPECT_EQ(quick.centre, m.centre);
  EXPECT_EQ(quick.normal, m.normal);
  EXPECT_EQ(quick.eta, 0);
}

TEST(MeshQuality, WarpageOfASaddle) {
  const double h = 0.3;
  const std::vector<Vec3> points{{0, 0, h}, {1, 0, -h}, {1, 1, h}, {0, 1, -h}};
  const std::vector<Id> row{0, 1, 2, 3};
  const FaceMeasures m = measureFace(points, {row.data(), row.data() + 4});
  // The central triangles' normals are (+-2h, 0, 1/2) and (0, +-2h, 1/2) up to a factor: opposite ones differ
  // most.
  EXPECT_NEAR(m.warpage(), 2 * std::atan(2 * h) * 180 / kPi, 1e-9);
  EXPECT_NEAR((m.normal - Vec3(0, 0, 1)).norm(), 0, 1e-14);
}

TEST(MeshQuality, ManyPointsOnAFace) {
  std::vector<Vec3> points;
  std::vector<Id> row;
  const int n = 100;
  for (int i = 0; i < n; ++i) {
    points.emplace_back(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n), 0);
    row.push_back(i);
  }
  const FaceMeasures m = measureFace(points, {row.data(), row.data() + n});
  EXPECT_NEAR(m.normal.z(), 0.5 * n * std::sin(2 * kPi / n), 1e-12);
  EXPECT_NEAR(m.centre.norm(), 0, 1e-14);
  EXPECT_NEAR(m.warpage(), 0, 1e-5);
}

TEST(MeshQuality, ShearedHexTurnsTheAngles) {
  for (double shear : {0.25, 1.0, 2.0}) {
    const PolyMesh mesh = stack({0, shear, 2 * shear});
    const MeshMeasures m = measure(mesh);
    const double expected = std::atan(shear) * 180 / kPi;
    for (double z : {0.0, 1.0, 2.0}) EXPECT_NEAR(m.faceAngle[faceWithin(mesh, z)], expected, 1e-5);
    EXPECT_NEAR(m.cells[0].volume, 1, 1e-14);
    EXPECT_NEAR((m.cells[1].centre - Vec3(0.5 + 1.5 * shear, 0.5, 1.5)).norm(), 0, 1e-14);
    const QualitySummary q = summarise(mesh, m, QualityLimits());
    EXPECT_NEAR(q.maxAngleInternal, expected, 1e-5);
    EXPECT_EQ(q.violations > 0, shear > std::tan(72 * kPi / 180));
  }
}

TEST(MeshQuality, SkewnessOfAKinkedStack) {
  // Centres (0.5, z 0.5) and (0.5 + s/2, z 1.5): their line meets z = 1 at 0.5 + s/4, the face's centre is at
  // 0.5.
  const double s = 0.8;
  const PolyMesh mesh = stack({0, 0, s});
  const MeshMeasures m = measure(mesh);
  EXPECT_NEAR(m.faceSkew[faceWithin(mesh, 1)], (s / 4) / 0.5, 1e-6);
  // On the boundary the line is along the normal: the sheared cell's top is s/4 off, the face reaches 0.5
  // that way.
  EXPECT_NEAR(m.faceSkew[faceWithin(mesh, 2)], (s / 2) / 0.5, 1e-6);
}

TEST(MeshQuality, InvertedCellIsReported) {
  PolyMesh mesh = stack({0, 0, 0});
  for (Vec3& p : mesh.points) {
    if (p.z() == 2) p.z() = 0.5;
  }
  const MeshMeasures m = measure(mesh);
  EXPECT_LT(m.cells[1].volume, 0);
  EXPECT_LT(m.cells[1].minTet, 0);
  const QualitySummary q = summarise(mesh, m, QualityLimits());
  EXPECT_NEAR(q.minVolume, -0.5, 1e-14);
  EXPECT_GT(q.violations, 0);
  const std::string text = describeViolations(mesh, m, QualityLimits());
  EXPECT_EQ(text.find("1 of 2 cells are outside a limit: volume"), 0u) << text;
  EXPECT_NE(text.find("the worst is -0.5 at id 1"), std::string::npos) << text;
}

TEST(MeshQuality, VolumesAreInFinestCells) {
  PolyMesh mesh = stack({0, 0});
  mesh.finestSize = 10;
  const QualitySummary q = summarise(mesh, measure(mesh), QualityLimits());
  EXPECT_NEAR(q.minVolume, 1e-3, 1e-16);
  EXPECT_NEAR(q.totalVolume, 1, 1e-14);
  EXPECT_EQ(q.violations, 1);
}

PolyMesh roomWithBlock() {
  testing::VoxelOptions o;
  o.size = {4, 4, 3};
  o.occupied = [](int i, int j, int k) { return !(i == 1 && j == 2 && k == 1); };
  o.deform = [](const Vec3& p) {
    return Vec3(p +
                0.06 * Vec3(std::sin(3 * p.y()), std::cos(2 * p.z() + p.x()), std::sin(p.x() + 2 * p.y())));
  };
  return testing::layeredVoxels(o);
}

void expectSame(const PolyMesh& mesh, const PolyMesh& moved, double scale, double tolerance) {
  const MeshMeasures a = measure(mesh), b = measure(moved);
  for (Id c = 0; c < mesh.cellCount; ++c) {
    ASSERT_NEAR(b.cells[c].volume / (scale * scale * scale) / a.cells[c].volume, 1, tolerance);
    ASSERT_NEAR(b.cells[c].minTet / (scale * scale * scale) / a.cells[c].minTet, 1, tolerance * 100);
    ASSERT_LT(b.openness[c], std::max(1e-14, tolerance));
  }
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    ASSERT_NEAR(b.faces[f].eta, a.faces[f].eta, tolerance);
    ASSERT_NEAR(b.faces[f].warpage(), a.faces[f].warpage(), 1e-5 + 100 * tolerance);
    ASSERT_NEAR(b.faceAngle[f], a.faceAngle[f], 1e-4 + 100 * tolerance);
    ASSERT_NEAR(b.faceSkew[f], a.faceSkew[f], 1e-6 + 10 * tolerance);
  }
}

TEST(MeshQuality, ScaleDoesNotMatter) {
  const PolyMesh mesh = roomWithBlock();
  for (double scale : {1e-30, 1e-3, 1e30}) {
    PolyMesh moved = mesh;
    for (Vec3& p : moved.points) p *= scale;
    expectSame(mesh, moved, scale, 1e-11);
  }
}

TEST(MeshQuality, FarOriginDoesNotMatter) {
  const PolyMesh mesh = roomWithBlock();
  PolyMesh moved = mesh;
  for (Vec3& p : moved.points) p += Vec3(512345.25, 5412345.5, 300);
  expectSame(mesh, moved, 1, 1e-7);  // coordinates themselves are rounded to 1e-9
}

TEST(MeshQuality, FarOriginCostsFacesNoDigits) {
  // Coordinates that stay exact when shifted: only the arithmetic could lose digits.
  PolyMesh mesh = roomWithBlock();
  for (Vec3& p : mesh.points) p = (p * 1048576).array().round() / 1048576;
  const Vec3 far = Vec3::Constant(8388608);
  PolyMesh moved = mesh;
  for (Vec3& p : moved.points) p += far;
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const FaceMeasures a = measureFace(mesh.points, mesh.faces[f]),
                       b = measureFace(moved.points, moved.faces[f]);
    ASSERT_LT((a.normal - b.normal).norm(), 1e-14);
    ASSERT_NEAR(a.eta, b.eta, 1e-13);
    ASSERT_LT((a.centre - (b.centre - far)).norm(), 4e-9);
  }
}

TEST(MeshQuality, CellPointsAreTheCorners) {
  const PolyMesh mesh = roomWithBlock();
  const Csr<Id> points = cellPoints(mesh), cells = pointCells(mesh, cellFaces(mesh));
  std::size_t total = 0;
  for (Id c = 0; c < mesh.cellCount; ++c) {
    EXPECT_EQ(points[c].size(), 8u);
    EXPECT_TRUE(std::is_sorted(points[c].begin(), points[c].end()));
    for (Id p : points[c]) EXPECT_TRUE(std::binary_search(cells[p].begin(), cells[p].end(), c));
    total += points[c].size();
  }
  EXPECT_EQ(total, cells.values.size());
}

}  // namespace
}  // namespace pm
