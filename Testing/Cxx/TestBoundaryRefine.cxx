// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryRefine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <set>

#include "TestMeshes.h"

namespace pm {
namespace {

using testing::cubeInBox;
using testing::layeredPolygons;
using testing::layeredVoxels;
using testing::VoxelOptions;

VoxelOptions blockOptions() {
  VoxelOptions o;
  o.size = {4, 3, 2};
  o.wallSide = {false, false, false, false, false, true};
  return o;
}

/// An L-shaped room between two domain sides: convex, concave and flat wall edges.
VoxelOptions elbow() {
  VoxelOptions o;
  o.size = {5, 4, 5};
  o.wallSide = {true, true, false, false, true, true};
  o.occupied = [](int i, int, int k) { return i < 2 || k < 2; };
  return o;
}

VoxelOptions wavy(VoxelOptions o) {
  o.deform = [](const Vec3& p) {
    return Vec3(p.x(), p.y(), p.z() + 0.1 * p.z() * std::sin(2 * p.x()) * std::cos(1.5 * p.y()));
  };
  return o;
}

PolyMesh refine(const PolyMesh& mesh, const BoundaryRefineOptions& options,
                BoundaryRefineReport* report = nullptr) {
  Monitor monitor;
  return boundaryRefine(mesh, options, monitor, report);
}

/// Limits as the refined mesh keeps them: thin cells and their side faces are exempt.
QualityLimits thinLimits(QualityLimits limits = {}) {
  limits.minVolume = 0;
  limits.minEtaInternal = limits.minEtaBoundary = 0;
  return limits;
}

double totalVolume(const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; }

TEST(BoundaryRefine, KeepsTopologyVolumeAndTheRestOfTheMesh) {
  const PolyMesh meshes[] = {layeredVoxels(blockOptions()), layeredVoxels(wavy(blockOptions())),
                             layeredVoxels(cubeInBox()), layeredVoxels(elbow()),
                             layeredVoxels(VoxelOptions())};
  for (const PolyMesh& mesh : meshes) {
    ASSERT_EQ(checkTopology(mesh), "");
    BoundaryRefineReport report;
    const PolyMesh refined = refine(mesh, {}, &report);
    EXPECT_EQ(checkTopology(refined), "");
    EXPECT_EQ(refined.stage, Stage::Refined);
    EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
    EXPECT_EQ(refined.cellCount, mesh.cellCount + 2 * report.wallFaces);
    EXPECT_EQ(report.facesByLayers, (std::vector<Id>{0, 0, report.wallFaces}));
    for (std::size_t p = 0; p < mesh.points.size(); ++p) EXPECT_EQ(refined.points[p], mesh.points[p]);
    const MeshMeasures before = measure(mesh), after = measure(refined);
    for (Id c = 0; c < mesh.cellCount; ++c) {
      EXPECT_EQ(refined.layer[c], mesh.layer[c]);
      if (mesh.layer[c] == 1) continue;
      EXPECT_NEAR(after.cells[c].volume, before.cells[c].volume, 1e-14);
    }
    EXPECT_EQ(describeViolations(refined, after, thinLimits()), "");
  }
}

TEST(BoundaryRefine, PatchesKeepTheirArea) {
  const PolyMesh mesh = layeredVoxels(elbow()), refined = refine(mesh, {});
  const auto areas = [](const PolyMesh& m) {
    std::vector<double> sums(m.patchNames.size(), 0.0);
    for (Id i = 0; i < m.boundaryFaces(); ++i) {
      sums[m.patch[i]] += measureFace(m.points, m.faces[m.internalFaces() + i], true).normal.norm();
    }
    return sums;
  };
  const std::vector<double> before = areas(mesh), after = areas(refined);
  EXPECT_EQ(refined.patchNames, mesh.patchNames);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
}

TEST(BoundaryRefine, HeightsFollowFromLayersAndExpansion) {
  BoundaryRefineOptions options;
  options.layers = 5;
  options.expansion = 1.4;
  const PolyMesh mesh = layeredVoxels(blockOptions()), refined = refine(mesh, options);
  const double h1 = (1.0 / 3) * 0.4 / (std::pow(1.4, 5) - 1), top = 2 + 1.0 / 3;
  std::set<double> expected{2, top};
  for (int i = 1; i < 5; ++i) expected.insert(top - h1 * (std::pow(1.4, i) - 1) / 0.4);
  std::map<std::pair<double, double>, std::set<double>> columns;
  for (const Vec3& p : refined.points) {
    if (p.z() >= 2) columns[{p.x(), p.y()}].insert(p.z());
  }
  ASSERT_EQ(columns.size(), 5u * 4);
  for (const auto& [xy, heights] : columns) {
    ASSERT_EQ(heights.size(), expected.size());
    auto e = expected.begin();
    for (double z : heights) EXPECT_NEAR(z, *e++, 1e-12);
  }
}

TEST(BoundaryRefine, FirstHeightIsKeptAboveEachWallFaceAlsoAtEdges) {
  // Prism edges lean at the cube's edges and corners: heights above the faces must be the same there.
  BoundaryRefineOptions options;
  options.layers = 4;
  options.firstHeight = 0.01;
  options.expansion = 1.5;
  const PolyMesh mesh = layeredVoxels(cubeInBox()), refined = refine(mesh, options);
  std::map<int, int> atHeight;
  for (std::size_t i = mesh.points.size(); i < refined.points.size(); ++i) {
    const double outside = (refined.points[i] - Vec3::Constant(2.5)).cwiseAbs().maxCoeff() - (0.5 - 1.0 / 3);
    const double sums[] = {0.01, 0.025, 0.0475};
    for (int k = 0; k < 3; ++k) atHeight[k] += std::abs(outside - sums[k]) < 1e-12;
  }
  EXPECT_EQ(atHeight[0], 8);
  EXPECT_EQ(atHeight[1], 8);
  EXPECT_EQ(atHeight[2], 8);
  EXPECT_EQ(refined.points.size(), mesh.points.size() + 24);
}

TEST(BoundaryRefine, LayerAndBaseArraysDescribeTheColumns) {
  BoundaryRefineOptions options;
  options.firstHeight = 0.02;
  const PolyMesh mesh = layeredVoxels(blockOptions()), refined = refine(mesh, options);
  const MeshMeasures m = measure(refined);
  for (Id c = 0; c < refined.cellCount; ++c) {
    const double below = 2 + 1.0 / 3 - m.cells[c].centre.z();
    const int expected = below > 1.0 / 3 ? 0 : below < 0.02 ? 1 : below < 0.044 ? 2 : 3;
    EXPECT_EQ(refined.layer[c], expected);
  }
  for (std::size_t p = 0; p < refined.points.size(); ++p) {
    const bool wall = refined.points[p].z() > 2.3333;
    ASSERT_EQ(refined.base[p] != kNone, wall);
    const double height = wall ? (refined.points[p] - refined.points[refined.base[p]]).z() : 0.02;
    EXPECT_NEAR(height, 0.02, 1e-12);
    const Vec3& at = refined.points[p];
    const int onX = at.x() == 0 || at.x() == 4, onY = at.y() == 0 || at.y() == 3, onZ = at.z() == 0;
    EXPECT_EQ(refined.fixed[p], onX + 2 * onY + 4 * onZ);
  }
}

TEST(BoundaryRefine, FewerLayersWhereTheyDoNotFit) {
  // The layer gets thin towards x = 4; each column takes what fits, and neighbours differ by one at most.
  VoxelOptions o = blockOptions();
  o.size = {12, 3, 2};
  o.deform = [](const Vec3& p) { return Vec3(p.x(), p.y(), p.z() <= 2 ? p.z() : p.z() - 0.02 * p.x()); };
  const PolyMesh mesh = layeredVoxels(o);
  BoundaryRefineOptions options;
  options.layers = 6;
  options.firstHeight = 0.05;
  options.makeRoom = false;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(mesh, options, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
  EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits()), "");
  // Two layers need 0.05 + 0.05, three 0.05 + 0.06 + 0.06, .. ; the edge at x is 1/3 - 0.02 x long.
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{3, 9, 15, 9, 0, 0}));
  std::vector<Id> layersAtX(12, 0);
  const MeshMeasures m = measure(refined);
  for (Id c = 0; c < refined.cellCount; ++c) {
    Id& most = layersAtX[static_cast<int>(m.cells[c].centre.x())];
    most = std::max<Id>(most, refined.layer[c]);
  }
  for (int i = 0; i + 1 < 12; ++i) {
    EXPECT_GE(layersAtX[i], layersAtX[i + 1]);
    EXPECT_LE(layersAtX[i], layersAtX[i + 1] + 1);
  }
  for (Id c = 0; c < refined.cellCount; ++c) {
    if (refined.layer[c] != 1 || layersAtX[static_cast<int>(m.cells[c].centre.x())] == 1) continue;
    EXPECT_NEAR(m.cells[c].volume, 0.05, 0.05 * 1e-3);  // the wall leans by 0.02
  }
}

TEST(BoundaryRefine, LimitsTakeLayersAway) {
  const PolyMesh mesh = layeredVoxels(elbow());
  BoundaryRefineOptions options;
  BoundaryRefineReport all, some;
  const PolyMesh open = refine(mesh, options, &all);
  ASSERT_GT(summarise(open, measure(open), {}).maxAngleInternal, 20);
  ASSERT_LT(summarise(mesh, measure(mesh), {}).maxAngleInternal, 20);
  options.limits.maxAngleInternal = 20;
  const PolyMesh kept = refine(mesh, options, &some);
  EXPECT_EQ(checkTopology(kept), "");
  EXPECT_NEAR(totalVolume(kept) / totalVolume(mesh), 1, 1e-12);
  EXPECT_EQ(describeViolations(kept, measure(kept), thinLimits(options.limits)), "");
  EXPECT_EQ(all.facesByLayers[2], all.wallFaces);
  EXPECT_LT(some.facesByLayers[2], some.wallFaces);
  EXPECT_GT(some.facesByLayers[2], 0);  // flat parts keep theirs
}

TEST(BoundaryRefine, LayersLeanAwayFromWallsThatAreTooSkewForThem) {
  // Rows of wall points pulled to one side and the other in turn: between thin layers that stand straight on
  // such faces the angle is above 70 degrees, though in the whole prisms it is not.
  VoxelOptions o;
  o.size = {5, 5, 2};
  o.wallSide = {false, false, false, false, false, true};
  o.thickness = 0.45;
  o.deform = [](const Vec3& p) {
    const bool moves = p.z() > 2 && p.x() > 0 && p.x() < 5 && p.y() > 0 && p.y() < 5;
    const double side = static_cast<int>(p.y()) % 2 == 0 ? 0.48 : -0.48;
    return Vec3(p.x() + (moves ? side : 0), 0.32 * p.y(), p.z());
  };
  const PolyMesh mesh = layeredVoxels(o);
  ASSERT_EQ(describeViolations(mesh, measure(mesh), thinLimits()), "");
  BoundaryRefineOptions options;
  options.layers = 5;
  options.makeRoom = false;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(mesh, options, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
  EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits()), "");
  EXPECT_EQ(report.facesByLayers[4], report.wallFaces);
}

TEST(BoundaryRefine, PolygonsWithMidEdgeNodes) {
  // A large column beside two small ones: its faces are pentagons.
  const std::vector<std::array<double, 2>> points{{0, 0}, {2, 0}, {2, 1}, {2, 2},
                                                  {0, 2}, {3, 0}, {3, 1}, {3, 2}};
  const PolyMesh mesh = layeredPolygons(points, {{0, 1, 2, 3, 4}, {1, 5, 6, 2}, {2, 6, 7, 3}}, 0.5);
  ASSERT_EQ(checkTopology(mesh), "");
  const PolyMesh refined = refine(mesh, {});
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_EQ(refined.cellCount, 3 + 9);
  EXPECT_NEAR(totalVolume(refined), 6 * 1.5, 1e-12);
}

TEST(BoundaryRefine, MergedWallNodesKeepTheirLayers) {
  const PolyMesh block = layeredVoxels(blockOptions());
  const auto wallPointAt = [&](double x, double y) {
    for (Id p = 0; p < static_cast<Id>(block.points.size()); ++p) {
      if (block.base[p] != kNone && block.points[p].x() == x && block.points[p].y() == y) return p;
    }
    return kNone;
  };
  const Id a = wallPointAt(2, 1), b = wallPointAt(2, 2);
  PolyMesh merged = testing::mergeWallPoints(block, std::min(a, b), std::max(a, b));
  merged.points[std::min(a, b)].y() = 1.5;
  ASSERT_EQ(checkTopology(merged), "");
  BoundaryRefineReport report;
  const PolyMesh refined = refine(merged, {}, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_NEAR(totalVolume(refined) / totalVolume(merged), 1, 1e-12);
  EXPECT_EQ(report.facesByLayers[2], 12);
  EXPECT_EQ(describeViolations(refined, measure(refined), thinLimits()), "");
}

TEST(BoundaryRefine, CellThatIsNoPrismStaysWhole) {
  // Without its layer mark a cell is like any other; the points of the columns beside it lie on its faces.
  PolyMesh mesh = layeredVoxels(blockOptions());
  const MeshMeasures m = measure(mesh);
  Id odd = kNone;
  for (Id c = 0; c < mesh.cellCount; ++c) {
    if (mesh.layer[c] == 1 && (m.cells[c].centre.head<2>() - Eigen::Vector2d(1.5, 1.5)).norm() < 0.1) odd = c;
  }
  ASSERT_NE(odd, kNone);
  mesh.layer[odd] = 0;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(mesh, {}, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_NEAR(totalVolume(refined) / totalVolume(mesh), 1, 1e-12);
  EXPECT_NEAR(measure(refined).cells[odd].volume, m.cells[odd].volume, 1e-14);
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{1, 4, 7}));  // graded: its four neighbours have two
}

TEST(BoundaryRefine, OneLayerIsTheInput) {
  BoundaryRefineOptions options;
  options.layers = 1;
  PolyMesh mesh = layeredVoxels(elbow());
  const PolyMesh refined = refine(mesh, options);
  mesh.stage = Stage::Refined;
  EXPECT_EQ(checksum(refined), checksum(mesh));
}

TEST(BoundaryRefine, SameBitsForAnyNumberOfThreads) {
  VoxelOptions o = elbow();
  o.size = {9, 8, 9};
  BoundaryRefineOptions options;
  options.layers = 4;
  options.limits.maxAngleInternal = 20;
  const PolyMesh mesh = layeredVoxels(wavy(o));
  std::set<std::uint64_t> sums;
  for (std::size_t threads : {1, 2, 4}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    sums.insert(checksum(refine(mesh, options)));
  }
  EXPECT_EQ(sums.size(), 1u);
}

TEST(BoundaryRefine, SmallAndFarModelsAreTheSame) {
  const PolyMesh mesh = layeredVoxels(elbow());
  BoundaryRefineOptions options;
  options.limits.maxAngleInternal = 20;
  BoundaryRefineReport expected;
  refine(mesh, options, &expected);
  for (double scale : {1e-30, 1e-3, 1e20}) {
    PolyMesh other = mesh;
    for (Vec3& p : other.points) p *= scale;
    other.finestSize *= scale;
    BoundaryRefineReport report;
    refine(other, options, &report);
    EXPECT_EQ(report.facesByLayers, expected.facesByLayers);
  }
}

TEST(BoundaryRefine, RefusesWhatItCannotUse) {
  const PolyMesh mesh = layeredVoxels(blockOptions());
  const auto with = [](const auto& edit) {
    BoundaryRefineOptions options;
    edit(options);
    return options;
  };
  EXPECT_THROW(refine(mesh, with([](auto& o) { o.layers = 0; })), InputError);
  EXPECT_THROW(refine(mesh, with([](auto& o) { o.layers = 1000; })), InputError);
  EXPECT_THROW(refine(mesh, with([](auto& o) { o.expansion = 0; })), InputError);
  EXPECT_THROW(refine(mesh, with([](auto& o) { o.firstHeight = -1; })), InputError);
  EXPECT_THROW(refine(refine(mesh, {}), {}), InputError);
  PolyMesh bare = mesh;
  bare.stage = Stage::Front;
  EXPECT_THROW(refine(bare, {}), InputError);
}

TEST(BoundaryRefine, WarnsOfCellsTooFlatForCheckMesh) {
  struct Listener : Monitor {
    std::vector<std::string> warnings;
    void warning(const std::string& sentence) override { warnings.push_back(sentence); }
  };
  BoundaryRefineOptions options;
  for (double height : {0.002, 0.0005}) {
    Listener listener;
    options.firstHeight = height;
    boundaryRefine(layeredVoxels(blockOptions()), options, listener);
    EXPECT_EQ(listener.warnings.size(), height < 0.001 ? 1u : 0u);
  }
}

TEST(BoundaryRefine, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(boundaryRefine(layeredVoxels(blockOptions()), {}, stop), AbortError);
}

}  // namespace
}  // namespace pm
