// SPDX-License-Identifier: BSD-3-Clause
// The choice of cuts, its mending towards central tetrahedra, and the order of points.
#include "CellCuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "CutAssembly.h"
#include "MeshQuality.h"
#include "PointOrder.h"
#include "PolygonPrism.h"
#include "TestMeshes.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// Voxels with a layer, warped: no face of theirs is flat.
PolyMesh warped() {
  VoxelOptions o;
  o.deform = [](const Vec3& p) {
    return Vec3(p +
                0.08 * Vec3(std::sin(3 * p[1] + p[2]), std::sin(2 * p[2] + p[0]), std::sin(4 * p[0] + p[1])));
  };
  return layeredVoxels(o);
}

double volumeOf(const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; }

TEST(CellCuts, TetShapeIsOneForARegularOneAndSigned) {
  const Vec3 a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
  EXPECT_NEAR(std::abs(tetShape(a, b, c, d)), 1, 1e-14);
  EXPECT_NEAR(tetShape(a, b, c, d), -tetShape(a, c, b, d), 1e-14);
  EXPECT_GT(tetShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  EXPECT_EQ(tetShape({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}), 0);
  EXPECT_EQ(tetShape(a, a, a, a), 0);
}

TEST(CellCuts, MendingEndsInCentralTetrahedra) {
  const PolyMesh mesh = warped();
  Monitor monitor;
  CutChooser chooser(mesh, false);
  const CellCuts& cuts = chooser.choose(monitor);
  EXPECT_GT(std::count_if(cuts.apex.begin(), cuts.apex.end(), [](Id a) { return a >= 0; }), 0);
  std::vector<Id> all(mesh.cellCount), firstCell;
  std::iota(all.begin(), all.end(), Id(0));
  chooser.mend(all, monitor);
  EXPECT_EQ(std::count(cuts.apex.begin(), cuts.apex.end(), CellCuts::kCentre), mesh.cellCount);
  EXPECT_EQ(checkTopology(assembleCuts(mesh, cuts, monitor, firstCell)), "");
  chooser.mend(all, monitor);
  EXPECT_EQ(std::count(cuts.fan.begin(), cuts.fan.end(), CellCuts::kCentre), mesh.faceCount());
  const PolyMesh out = assembleCuts(mesh, cuts, monitor, firstCell);
  EXPECT_EQ(checkTopology(out), "");
  EXPECT_EQ(out.cellCount, 24 * mesh.cellCount);  // four on each of a hexahedron's faces
  EXPECT_EQ(firstCell.back(), out.cellCount);
  EXPECT_NEAR(volumeOf(out), volumeOf(mesh), 1e-12 * volumeOf(mesh));
  EXPECT_GT(summarise(out, measure(out), {}).minTet, 0);
}

TEST(CellCuts, MendingLeavesCellsThatStay) {
  const PolyMesh mesh = warped();
  Monitor monitor;
  CutChooser chooser(mesh, true);
  const std::vector<Id> apex = chooser.choose(monitor).apex;
  EXPECT_EQ(std::count(apex.begin(), apex.end(), CellCuts::kWhole), mesh.cellCount);
  std::vector<Id> all(mesh.cellCount);
  std::iota(all.begin(), all.end(), Id(0));
  EXPECT_EQ(chooser.mend(all, monitor).apex, apex);
}

TEST(PointOrder, HangingPointsComeFirst) {
  // A square whose edge from 1 to 2 has point 6 in its middle, extruded.
  const PolyMesh mesh = layeredPolygons({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0.5}}, {{0, 1, 4, 2, 3}}, 0.5);
  const PointOrder order(mesh);
  for (Id p = 0; p < Id(mesh.points.size()); ++p) {
    const bool hangs = mesh.points[p][0] == 1 && mesh.points[p][1] == 0.5;
    for (Id q = 0; q < Id(mesh.points.size()); ++q) {
      const bool other = mesh.points[q][0] == 1 && mesh.points[q][1] == 0.5;
      if (hangs && !other) {
        EXPECT_TRUE(order.before(p, q));
      }
      if (p != q) {
        EXPECT_NE(order.before(p, q), order.before(q, p));
      }
      if (hangs == other && mesh.points[p].sum() < mesh.points[q].sum()) {
        EXPECT_TRUE(order.before(p, q));
      }
    }
  }
}

TEST(PolygonPrism, FindsCornersThatLieOverEachOther) {
  const PolyMesh mesh = layeredPolygons({{0, 0}, {2, 0}, {2, 1}, {1, 2}, {0, 1}}, {{0, 1, 2, 3, 4}}, 0.5);
  const Csr<Id> facesOf = cellFaces(mesh);
  for (Id c = 0; c < mesh.cellCount; ++c) {
    PolygonPrism prism;
    ASSERT_TRUE(findPrism(mesh, facesOf[c], c, prism));
    ASSERT_EQ(prism.size(), 5u);
    int wedges = 0;
    double volume = 0;
    forEachWedge(prism, 2, [&](const std::array<Id, 3>& below, const std::array<Id, 3>& above) {
      ++wedges;
      const auto at = [&](Id p) { return mesh.points[p]; };
      for (int i = 0; i < 3; ++i) EXPECT_EQ(at(below[i]).head<2>(), at(above[i]).head<2>());
      const Vec3 twice = (at(below[1]) - at(below[0])).cross(at(below[2]) - at(below[0]));
      volume -= 0.5 * twice.dot(at(above[0]) - at(below[0]));  // the base is seen from outside
    });
    EXPECT_EQ(wedges, 3);
    EXPECT_NEAR(volume, 3 * (c == 0 ? 1 : 0.5), 1e-12);
  }
  const PolyMesh cubes = layeredVoxels({});
  PolygonPrism none;
  EXPECT_FALSE(findPrism(cubes, cellFaces(cubes)[0], 0, none));
}

}  // namespace
