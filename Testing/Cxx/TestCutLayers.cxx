// SPDX-License-Identifier: BSD-3-Clause
// Boundary layers below wall faces that are cut in parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "BoundaryRefine.h"
#include "TestMeshes.h"
#include "TestSurfaces.h"
#include "WallCuts.h"

namespace {

using namespace pm;
using namespace pm::testing;

VoxelOptions floorOf(int x, int y) {
  VoxelOptions o;
  o.size = {x, y, 2};
  o.wallSide = {false, false, false, false, false, true};
  return o;
}

/// An L-shaped room between two domain sides: convex, concave and flat wall edges.
VoxelOptions elbow(int size) {
  VoxelOptions o;
  o.size = {size, 4, size};
  o.wallSide = {true, true, false, false, true, true};
  o.occupied = [](int i, int, int k) { return i < 2 || k < 2; };
  return o;
}

PolyMesh refine(const PolyMesh& mesh, const BoundaryRefineOptions& options,
                BoundaryRefineReport* report = nullptr) {
  Monitor monitor;
  return boundaryRefine(mesh, options, monitor, report);
}

/// Limits as the refined mesh keeps them: thin cells and their side faces are exempt.
QualityLimits thinLimits(QualityLimits limits) {
  limits.minVolume = 0;
  limits.minEtaInternal = limits.minEtaBoundary = 0;
  return limits;
}

double totalVolume(const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; }

/// Every `nth` wall face of four or more points cut, between its first point and the one across.
PolyMesh cutWall(PolyMesh mesh, int nth) {
  std::vector<WallCut> cuts;
  int count = 0;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    if (!mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()]) || row.size() < 4) continue;
    if (count++ % nth == 0) cuts.push_back({f, row[0], row[2]});
  }
  cutWallFaces(mesh, cuts);
  canonicalise(mesh);
  return mesh;
}

/// What holds when every wall face of a cut mesh has a prism and three layers of its own.
PolyMesh expectAllLayers(const PolyMesh& mesh, const QualityLimits& limits = {}) {
  EXPECT_EQ(checkTopology(mesh), "");
  BoundaryRefineOptions options;
  options.limits = limits;
  options.makeRoom = false;
  BoundaryRefineReport report;
  PolyMesh refined = refine(mesh, options, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{0, 0, report.wallFaces}));
  EXPECT_EQ(std::count(refined.layer.begin(), refined.layer.end(), 1), report.wallFaces);
  EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits(limits)), "");
  return refined;
}

Id wallFaces(const PolyMesh& mesh) {
  return static_cast<Id>(
      std::count_if(mesh.patch.begin(), mesh.patch.end(), [&](Id p) { return mesh.isWallPatch(p); }));
}

TEST(CutLayers, EachPartOfACutFaceHasItsOwnPrism) {
  for (const VoxelOptions& o : {floorOf(4, 3), cubeInBox(), elbow(5), VoxelOptions()}) {
    const PolyMesh mesh = layeredVoxels(o);
    for (int nth : {1, 2, 3}) {
      const PolyMesh cut = cutWall(mesh, nth), refined = expectAllLayers(cut);
      const Id cuts = wallFaces(cut) - wallFaces(mesh);
      EXPECT_EQ(refined.cellCount, cut.cellCount + cuts + 2 * wallFaces(cut));
      // A side face below each cut in three layers, two caps more and one lower face more.
      EXPECT_EQ(refined.internalFaces(), refine(mesh, {}).internalFaces() + cuts * (3 + 2 + 1));
    }
  }
}

TEST(CutLayers, OneLayerLeavesCutFacesAsTheyAre) {
  BoundaryRefineOptions options;
  options.layers = 1;
  PolyMesh cut = cutWall(layeredVoxels(elbow(5)), 2);
  const PolyMesh refined = refine(cut, options);
  cut.stage = Stage::Refined;
  EXPECT_EQ(checksum(refined), checksum(cut));
}

TEST(CutLayers, LayersFollowAFoldUpAndDown) {
  // A ridge or a valley along x = y, cut there: sharper than the layers are high.
  for (const double slope : {-0.15, 0.15}) {
    VoxelOptions o = floorOf(5, 5);
    o.deform = [slope](const Vec3& p) {
      return p.z() <= 2 ? p : Vec3(p.x(), p.y(), p.z() + 0.1 - slope * std::abs(p.x() - p.y()) * 0.5);
    };
    const PolyMesh mesh = layeredVoxels(o);
    std::vector<WallCut> cuts;
    for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
      if (!mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()])) continue;
      std::vector<Id> onRidge;
      for (Id p : mesh.faces[f])
        if (mesh.points[p].x() == mesh.points[p].y()) onRidge.push_back(p);
      if (onRidge.size() == 2) cuts.push_back({f, onRidge[0], onRidge[1]});
    }
    ASSERT_EQ(cuts.size(), 5u);
    PolyMesh cut = mesh;
    cutWallFaces(cut, cuts);
    canonicalise(cut);
    BoundaryRefineOptions options;
    options.firstHeight = 0.01;
    options.makeRoom = false;
    BoundaryRefineReport report;
    const PolyMesh refined = refine(cut, options, &report);
    EXPECT_EQ(report.facesByLayers, (std::vector<Id>{0, 0, 30}));
    EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits({})), "");
  }
}

TEST(CutLayers, ASplitThatBreaksALimitIsNotMade) {
  // Parts of a long face are long triangles: their cells' centres are aslant to the diagonal between them.
  VoxelOptions o = floorOf(4, 3);
  o.deform = [](const Vec3& p) { return Vec3(2 * p.x(), p.y(), p.z()); };
  const PolyMesh mesh = cutWall(layeredVoxels(o), 1);
  QualityLimits limits;
  limits.maxAngleInternal = 30;
  BoundaryRefineOptions options;
  options.limits = limits;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(mesh, options, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_EQ(report.wallFaces, 24);
  EXPECT_LT(std::count(refined.layer.begin(), refined.layer.end(), 1), 24);
  EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits(limits)), "");
}

TEST(CutLayers, CutFacesBesideMergedWallNodes) {
  const PolyMesh block = layeredVoxels(floorOf(4, 3));
  std::vector<Id> pair;
  for (Id p = 0; p < static_cast<Id>(block.points.size()); ++p) {
    const Vec3& at = block.points[p];
    if (block.base[p] != kNone && at.x() == 2 && (at.y() == 1 || at.y() == 2)) pair.push_back(p);
  }
  ASSERT_EQ(pair.size(), 2u);
  PolyMesh merged = mergeWallPoints(block, pair[0], pair[1]);
  merged.points[pair[0]].y() = 1.5;
  const PolyMesh cut = cutWall(merged, 1);
  EXPECT_EQ(cut.boundaryFaces(), merged.boundaryFaces() + 10);  // two are triangles
  expectAllLayers(cut);
}

TEST(CutLayers, CutFacesGetAsManyLayersAsTheLimitsAllow) {
  const PolyMesh mesh = layeredVoxels(cubeInBox()), cut = cutWall(mesh, 2);
  BoundaryRefineOptions options;
  Id last = 0;
  for (const double angle : {60.0, 72.0, 78.0, 87.0}) {
    options.limits.maxAngleBoundary = angle;
    BoundaryRefineReport report;
    const PolyMesh refined = refine(cut, options, &report);
    EXPECT_EQ(checkTopology(refined), "");
    EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits(options.limits)), "");
    EXPECT_GE(refined.cellCount, last);
    last = refined.cellCount;
  }
  EXPECT_EQ(last, mesh.cellCount + 3 + 2 * 9);
}

TEST(CutLayers, PolygonsCutSeveralTimes) {
  const std::vector<std::array<double, 2>> points{{0, 0}, {2, 0}, {2.3, 1}, {2, 2},
                                                  {0, 2}, {3, 0}, {3, 1},   {3, 2}};
  const PolyMesh mesh = layeredPolygons(points, {{0, 1, 2, 3, 4}, {1, 5, 6, 2}, {2, 6, 7, 3}}, 0.5);
  const PolyMesh once = cutWall(mesh, 1), twice = cutWall(once, 1);
  EXPECT_EQ(once.boundaryFaces(), mesh.boundaryFaces() + 3);
  EXPECT_EQ(twice.boundaryFaces(), once.boundaryFaces() + 1);
  for (const PolyMesh& cut : {once, twice}) expectAllLayers(cut);
}

TEST(CutLayers, CutFacesGiveTheSameBitsForAnyNumberOfThreads) {
  VoxelOptions o = elbow(9);
  o.deform = [](const Vec3& p) {
    return Vec3(p.x(), p.y(), p.z() + 0.1 * p.z() * std::sin(2 * p.x()) * std::cos(1.5 * p.y()));
  };
  BoundaryRefineOptions options;
  options.layers = 4;
  options.limits.maxAngleInternal = 25;
  options.limits.maxWarpage = 5;
  const PolyMesh mesh = cutWall(layeredVoxels(o), 2);
  std::set<std::uint64_t> sums;
  for (int threads : {1, 2, 4})
    withThreads(threads, [&] {
      const PolyMesh refined = refine(mesh, options);
      EXPECT_EQ(checkTopology(refined), "");
      EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
      sums.insert(checksum(refined));
    });
  EXPECT_EQ(sums.size(), 1u);
}

}  // namespace
