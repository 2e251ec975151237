// SPDX-License-Identifier: BSD-3-Clause
// What layers are wanted where: heights from thickness, y+ and both, patches of their own, coverage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "BoundaryRefine.h"
#include "TestMeshes.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// A floor of 8 by 4 columns; its left half is the patch "floor_left".
PolyMesh twoPatchFloor() {
  VoxelOptions o;
  o.size = {8, 4, 2};
  o.wallSide = {false, false, false, false, false, true};
  PolyMesh mesh = layeredVoxels(o);
  const Id left = static_cast<Id>(mesh.patchNames.size());
  mesh.patchNames.push_back("floor_left");
  mesh.patchTypes.push_back("wall");
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    const Id f = mesh.internalFaces() + i;
    if (mesh.isWallPatch(mesh.patch[i]) && measureFace(mesh.points, mesh.faces[f]).centre.x() < 4)
      mesh.patch[i] = left;
  }
  return mesh;
}

PolyMesh refine(const PolyMesh& mesh, const BoundaryRefineOptions& options, BoundaryRefineReport& report) {
  Monitor monitor;
  PolyMesh refined = boundaryRefine(mesh, options, monitor, &report);
  EXPECT_EQ(checkTopology(refined), "");
  QualityLimits limits = options.limits;
  limits.minVolume = limits.minEtaInternal = limits.minEtaBoundary = 0;
  EXPECT_EQ(describeViolations(refined, measure(refined), limits), "");
  return refined;
}

const PatchCoverage& row(const BoundaryRefineReport& report, const std::string& name) {
  return *std::find_if(report.patches.begin(), report.patches.end(),
                       [&](const PatchCoverage& p) { return p.name == name; });
}

TEST(LayerDemands, FlatPlate) {
  // Air at 10 m/s over 1 m: Re = 666,667, cf = 0.026 / 6.80, u = 10 sqrt(cf / 2) = 0.437.
  EXPECT_NEAR(flatPlateHeight(30, {10, 1, 1.5e-5}), 2 * 30 * 1.5e-5 / 0.4373, 1e-6);
  // Laminar: Re = 10,000, cf = 0.00664.
  EXPECT_NEAR(flatPlateHeight(1, {1, 1, 1e-4}), 2e-4 / std::sqrt(0.00332), 1e-9);
  // Scaling all lengths by 1000 scales the height.
  EXPECT_NEAR(flatPlateHeight(30, {1e4, 1e3, 15}) / flatPlateHeight(30, {10, 1, 1.5e-5}), 1000, 1e-9);
}

TEST(LayerDemands, ThicknessGivesTheFirstHeight) {
  BoundaryRefineOptions options;
  options.layers = 3;
  options.expansion = 1.5;
  options.thickness = 0.19;  // 0.04, 0.06, 0.09
  BoundaryRefineReport report;
  refine(twoPatchFloor(), options, report);
  for (std::size_t i = 0; i < report.faces.layers.size(); ++i) {
    if (report.faces.layers[i] == 0) continue;
    EXPECT_EQ(report.faces.layers[i], 3);
    EXPECT_NEAR(report.faces.firstHeight[i], 0.04, 1e-12);
    EXPECT_NEAR(report.faces.thickness[i], 1.0 / 3, 1e-12);  // the last layer takes what is left of the prism
  }
}

TEST(LayerDemands, HeightAndThicknessGiveTheExpansion) {
  BoundaryRefineOptions options;
  options.layers = 3;
  options.expansion = 7;  // not used
  options.firstHeight = 0.04;
  options.thickness = 0.19;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(twoPatchFloor(), options, report);
  const double second = 2 + 1.0 / 3 - 0.04 - 0.06;
  EXPECT_EQ(std::count_if(refined.points.begin(), refined.points.end(),
                          [&](const Vec3& p) { return std::abs(p.z() - second) < 1e-12; }),
            9 * 5);
}

TEST(LayerDemands, EvenGrowthFillsThePrism) {
  BoundaryRefineOptions options;
  options.layers = 4;
  options.firstHeight = 0.02;
  options.end = LayerEnd::EvenGrowth;
  options.makeRoom = false;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(twoPatchFloor(), options, report);
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{0, 0, 0, 32}));
  std::set<double> levels;
  for (const Vec3& p : refined.points)
    if (p.z() > 2 - 1e-9) levels.insert(std::round(p.z() * 1e9) / 1e9);
  ASSERT_EQ(levels.size(), 5u);
  std::vector<double> z(levels.rbegin(), levels.rend()), ratio;
  EXPECT_NEAR(z[0] - z[1], 0.02, 1e-8);
  for (int i = 0; i < 3; ++i) ratio.push_back((z[i + 1] - z[i + 2]) / (z[i] - z[i + 1]));
  EXPECT_GT(ratio[0], 1.2);
  EXPECT_NEAR(ratio[1], ratio[0], 1e-5);
  EXPECT_NEAR(ratio[2], ratio[0], 1e-5);
}

TEST(LayerDemands, PrismsAreMadeHigherForLayersThatNeedIt) {
  // The prisms are 1/3 high; the layers need 0.15 (1 + 1.2 + 1.44) = 0.546.
  BoundaryRefineOptions options;
  options.firstHeight = 0.15;
  BoundaryRefineReport report, kept;
  const PolyMesh mesh = twoPatchFloor(), refined = refine(mesh, options, report);
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{0, 0, 32}));
  EXPECT_GT(report.patches.back().thickness, 0.54);
  EXPECT_NEAR(report.patches.back().meanFirst, 0.15, 1e-3);
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.base[p] != kNone) {
      EXPECT_EQ(refined.points[p], mesh.points[p]);
    }
  options.makeRoom = false;
  refine(mesh, options, kept);
  EXPECT_EQ(kept.facesByLayers, (std::vector<Id>{0, 32, 0}));
  EXPECT_EQ(kept.patches.back().byReason[static_cast<int>(LayerReason::NoRoom)], 32);
}

TEST(LayerDemands, PatchesOfTheirOwn) {
  BoundaryRefineOptions options;
  options.layers = 4;
  options.patches = {{"*", {}}, {"floor_l?ft", {}}};
  options.patches[0].spec.layers = 4;
  options.patches[1].spec.layers = 0;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(twoPatchFloor(), options, report);
  // None on the left; on the right 2, 3, 4, 4 from the border on.
  EXPECT_EQ(report.facesByLayers, (std::vector<Id>{16, 4, 4, 8}));
  const PatchCoverage& left = row(report, "floor_left");
  EXPECT_EQ(left.faces, 16);
  EXPECT_EQ(left.wantedLayers, 1);
  EXPECT_EQ(left.allLayers, 1);
  EXPECT_EQ(left.byReason[static_cast<int>(LayerReason::NotWanted)], 16);
  const PatchCoverage& all = report.patches.back();
  EXPECT_EQ(all.faces, 32);
  EXPECT_NEAR(all.area, 32, 1e-12);
  EXPECT_NEAR(all.layers, (16 + 4 * 2 + 4 * 3 + 8 * 4) / 32.0, 1e-12);
  EXPECT_EQ(all.byReason[static_cast<int>(LayerReason::NeighbourLayers)], 8);
  EXPECT_EQ(all.covered, 1);
}

TEST(LayerDemands, TheThinnerLayersCountBetweenPatches) {
  BoundaryRefineOptions options;
  options.firstHeight = 0.04;
  options.patches = {{"floor_left", {}}};
  options.patches[0].spec.firstHeight = 0.02;
  BoundaryRefineReport report;
  const PolyMesh refined = refine(twoPatchFloor(), options, report);
  std::map<double, double> firstAt;  // by x: distance of the wall's edge points from the wall
  for (std::size_t p = 0; p < refined.points.size(); ++p)
    if (refined.base[p] != kNone)
      firstAt[refined.points[p].x()] = (refined.points[p] - refined.points[refined.base[p]]).norm();
  for (const auto& [x, height] : firstAt) EXPECT_NEAR(height, x <= 4 ? 0.02 : 0.04, 1e-12) << "at " << x;
}

TEST(LayerDemands, ContradictionsAreRefused) {
  const PolyMesh mesh = twoPatchFloor();
  const auto message = [&](const auto& edit) {
    BoundaryRefineOptions options;
    edit(options);
    Monitor monitor;
    try {
      boundaryRefine(mesh, options, monitor);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto expect = [&](const char* words, const auto& edit) {
    EXPECT_NE(message(edit).find(words), std::string::npos) << words << " is not in: " << message(edit);
  };
  expect("needs the flow", [](auto& o) { o.yPlus = 1; });
  expect("not both", [](auto& o) { o.yPlus = 1, o.firstHeight = 0.1, o.flow = {1, 1, 1e-4}; });
  expect("thickness", [](auto& o) { o.thickness = -1; });
  expect("cannot grow", [](auto& o) { o.firstHeight = 0.1, o.thickness = 0.1, o.layers = 1; });
  expect("cannot grow", [](auto& o) { o.firstHeight = 0.1, o.thickness = 0.05; });
  expect("No wall is named like 'nose'", [](auto& o) { o.patches = {{"nose", {}}}; });
  expect("of patches 'floor*'", [](auto& o) {
    o.patches = {{"floor*", {}}};
    o.patches[0].spec.layers = 101;
  });
  EXPECT_EQ(message([](auto& o) { o.yPlus = 1, o.flow = {1, 1, 1e-4}; }), "");
}

}  // namespace
