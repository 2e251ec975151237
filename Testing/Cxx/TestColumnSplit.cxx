// SPDX-License-Identifier: BSD-3-Clause
// Prism columns split along lines over the wall, and parts of meshes to try things out in.
#include "ColumnSplit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "LayerColumns.h"
#include "MeshQuality.h"
#include "SubMesh.h"
#include "TestMeshes.h"
#include "TestMoves.h"

namespace {

using namespace pm;
using namespace pm::testing;

double volumeOf(const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; }

Id splittableColumns(const PolyMesh& mesh) {
  const LayerColumns columns(mesh);
  Id count = 0;
  for (Id c = 0; c < columns.count(); ++c) count += columns.canSplit(c);
  return count;
}

/// Two squares beside each other, with prisms on top: wall points 0 .. 5 of the upper row follow the lower.
PolyMesh twoSquares() {
  return layeredPolygons({{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}, {{0, 1, 4, 3}, {1, 2, 5, 4}}, 0.4);
}

/// The wall point above (x, y).
Id wallPoint(const PolyMesh& mesh, double x, double y) {
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.base[p] != kNone && mesh.points[p].head<2>() == Eigen::Vector2d(x, y)) return static_cast<Id>(p);
  return kNone;
}

/// The wall face whose centre lies above (x, y).
Id wallFace(const PolyMesh& mesh, double x, double y) {
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f)
    if (mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()]) &&
        (measureFace(mesh.points, mesh.faces[f]).centre.head<2>() - Eigen::Vector2d(x, y)).norm() < 1e-12)
      return f;
  return kNone;
}

TEST(ColumnSplit, ALineOverTwoSquaresMakesFourPrisms) {
  PolyMesh mesh = twoSquares();
  const Id a = wallPoint(mesh, 0, 0), b = wallPoint(mesh, 2, 1);
  const WallPlace middle{wallPoint(mesh, 1, 0), wallPoint(mesh, 1, 1)};
  const WallPath path{{{a, kNone}, middle, {b, kNone}}, {wallFace(mesh, 0.5, 0.5), wallFace(mesh, 1.5, 0.5)}};
  const Csr<Id> faces = cellFaces(mesh);
  ASSERT_TRUE(canSplitColumns(mesh, faces, path));
  const double volume = volumeOf(mesh);
  const Id cells = mesh.cellCount, columns = splittableColumns(mesh);
  const std::size_t points = mesh.points.size();
  splitColumns(mesh, faces, {path});
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(mesh.cellCount, cells + 2);
  EXPECT_EQ(splittableColumns(mesh), columns + 2);
  ASSERT_EQ(mesh.points.size(), points + 2);
  const Id top = static_cast<Id>(points), low = top + 1;
  EXPECT_EQ(mesh.base[top], low);
  EXPECT_EQ(mesh.points[top].head<2>(), Eigen::Vector2d(1, 0.5));
  EXPECT_EQ(mesh.points[low].head<2>(), Eigen::Vector2d(1, 0.5));
  EXPECT_NEAR(volumeOf(mesh), volume, 1e-12);
  EXPECT_NE(wallFace(mesh, (0 + 1 + 1) / 3., (0 + 0 + 0.5) / 3.), kNone) << "a triangle beside the line";
}

TEST(ColumnSplit, AnEdgeAloneGivesBothColumnsOneSideMore) {
  PolyMesh mesh = twoSquares();
  const WallPath path{{{wallPoint(mesh, 1, 0), wallPoint(mesh, 1, 1)}}, {wallFace(mesh, 0.5, 0.5)}};
  const Csr<Id> faces = cellFaces(mesh);
  ASSERT_TRUE(canSplitColumns(mesh, faces, path));
  const double volume = volumeOf(mesh);
  const Id cells = mesh.cellCount, columns = splittableColumns(mesh), internal = mesh.internalFaces();
  const std::size_t points = mesh.points.size();
  splitColumns(mesh, faces, {path});
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(mesh.cellCount, cells);
  EXPECT_EQ(mesh.internalFaces(), internal + 1);
  EXPECT_EQ(splittableColumns(mesh), columns);
  EXPECT_EQ(mesh.points.size(), points + 2);
  EXPECT_NEAR(volumeOf(mesh), volume, 1e-12);
}

TEST(ColumnSplit, PathsOverOneEdgeShareItsNewPoint) {
  PolyMesh mesh = twoSquares();
  const WallPlace middle{wallPoint(mesh, 1, 0), wallPoint(mesh, 1, 1)};
  const WallPath left{{{wallPoint(mesh, 0, 0), kNone}, middle}, {wallFace(mesh, 0.5, 0.5)}};
  const WallPath right{{middle, {wallPoint(mesh, 2, 1), kNone}}, {wallFace(mesh, 1.5, 0.5)}};
  const Csr<Id> faces = cellFaces(mesh);
  const double volume = volumeOf(mesh);
  const Id cells = mesh.cellCount;
  const std::size_t points = mesh.points.size();
  splitColumns(mesh, faces, {{{middle}, left.faces}, left, right});
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(mesh.cellCount, cells + 2);
  EXPECT_EQ(mesh.points.size(), points + 2);
  EXPECT_NEAR(volumeOf(mesh), volume, 1e-12);
}

TEST(ColumnSplit, RefusesWhatWouldLeaveNoTwoPrisms) {
  const PolyMesh mesh = twoSquares();
  const Csr<Id> faces = cellFaces(mesh);
  const Id a = wallPoint(mesh, 0, 0), b = wallPoint(mesh, 1, 0), c = wallPoint(mesh, 1, 1);
  const Id left = wallFace(mesh, 0.5, 0.5), right = wallFace(mesh, 1.5, 0.5);
  const auto can = [&](const WallPath& path) { return canSplitColumns(mesh, faces, path); };
  EXPECT_TRUE(can({{{a, kNone}, {c, kNone}}, {left}}));
  EXPECT_FALSE(can({{{a, kNone}, {b, kNone}}, {left}})) << "along an edge";
  EXPECT_FALSE(can({{{b, kNone}, {b, c}}, {left}})) << "from an end of the edge to its middle";
  EXPECT_FALSE(can({{{a, kNone}, {c, wallPoint(mesh, 0, 1)}}, {left}})) << "an edge on the domain's side";
  EXPECT_TRUE(can({{{b, c}}, {left}})) << "an edge alone";
  EXPECT_FALSE(can({{{c, wallPoint(mesh, 0, 1)}}, {left}})) << "that on the domain's side alone";
  EXPECT_FALSE(can({{{a, kNone}}, {left}})) << "a point alone";
  EXPECT_FALSE(can({{{a, kNone}, {b, c}, {a, kNone}}, {left, left}})) << "twice through one column";
  EXPECT_FALSE(can({{{a, kNone}, {wallPoint(mesh, 2, 1), kNone}}, {right}})) << "a point of another face";
}

/// A way over one or two wall faces that can be split; none when chance finds none.
WallPath randomPath(const PolyMesh& mesh, const Csr<Id>& faces, std::mt19937_64& random) {
  const Id internal = mesh.internalFaces();
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int attempt = 0; attempt < 200; ++attempt) {
    const Id f = internal + static_cast<Id>(pick(mesh.boundaryFaces()));
    if (!mesh.isWallPatch(mesh.patch[f - internal])) continue;
    const Span<Id> row = mesh.faces[f];
    const std::size_t k = pick(row.size());
    const WallPlace edge{row[k], row[(k + 1) % row.size()]};
    WallPath path{{{row[pick(row.size())], kNone}, edge}, {f}};
    for (Id g = internal; g < mesh.faceCount(); ++g) {
      const Span<Id> other = mesh.faces[g];
      const auto has = [&](Id p) { return std::find(other.begin(), other.end(), p) != other.end(); };
      if (g == f || !mesh.isWallPatch(mesh.patch[g - internal]) || !has(edge.a) || !has(edge.b)) continue;
      path.places.push_back({other[pick(other.size())], kNone});
      path.faces.push_back(g);
      break;
    }
    if (path.faces.size() == 2 && canSplitColumns(mesh, faces, path)) return path;
  }
  return {};
}

TEST(ColumnSplit, RandomLinesLeaveASoundMeshOfPrisms) {
  int done = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    PolyMesh mesh = shaken(seed);
    const double volume = volumeOf(mesh);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 3; ++i) {  // on meshes that have been split before, too
      const Csr<Id> faces = cellFaces(mesh);
      const WallPath path = randomPath(mesh, faces, random);
      if (path.faces.empty()) continue;
      const Id cells = mesh.cellCount, columns = splittableColumns(mesh);
      splitColumns(mesh, faces, {path});
      ++done;
      ASSERT_EQ(checkTopology(mesh), "") << seed;
      EXPECT_EQ(mesh.cellCount, cells + 2) << seed;
      EXPECT_EQ(splittableColumns(mesh), columns + 2) << seed;
      EXPECT_NEAR(volumeOf(mesh), volume, 0.02 * volume) << seed;  // warped faces meet the new edge elsewhere
    }
  }
  EXPECT_GT(done, 60);
}

TEST(SubMesh, MeasuresAsTheWhole) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const PolyMesh mesh = shaken(seed);
    const Csr<Id> faces = cellFaces(mesh);
    std::vector<Id> cells;
    for (Id c = static_cast<Id>(seed) % 3; c < mesh.cellCount; c += 3) cells.push_back(c);
    const SubMesh part = subMesh(mesh, faces, cells);
    ASSERT_EQ(part.mesh.cellCount, static_cast<Id>(cells.size()));
    const MeshMeasures own = measure(part.mesh), all = measure(mesh);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      EXPECT_NEAR(own.cells[i].volume, all.cells[cells[i]].volume, 1e-12);
      EXPECT_LT((own.cells[i].centre - all.cells[cells[i]].centre).norm(), 1e-12);
      EXPECT_LT(own.openness[i], 1e-9);
    }
    for (Id f = 0; f < part.mesh.faceCount(); ++f) {
      const bool boundary = part.faces[f] >= mesh.internalFaces();
      EXPECT_EQ(part.boundaryFaceOf(part.faces[f]), boundary ? f : kNone);
    }
    for (std::size_t p = 0; p < part.points.size(); ++p) {
      const Id base = mesh.base[part.points[p]];
      if (part.mesh.base[p] == kNone) continue;
      EXPECT_EQ(part.points[part.mesh.base[p]], base);
    }
    for (Id f = 0; f < part.mesh.faceCount(); ++f)
      EXPECT_EQ(part.mesh.faces[f].size(), mesh.faces[part.faces[f]].size());
  }
}

}  // namespace
