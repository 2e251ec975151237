// SPDX-License-Identifier: BSD-3-Clause
// How layers grow, inside and into the volume, where it can be computed by hand.
#include "LayerGrowth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "BoundaryRefine.h"
#include "MeshQuality.h"
#include "TestMeshes.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// Prisms of height 1/3 on unit cubes.
PolyMesh block() {
  VoxelOptions o;
  o.size = {4, 3, 2};
  o.wallSide = {false, false, false, false, false, true};
  return layeredVoxels(o);
}

BoundaryRefineReport reportOf(const PolyMesh& mesh, const BoundaryRefineOptions& options) {
  Monitor monitor;
  BoundaryRefineReport report;
  boundaryRefine(mesh, options, monitor, &report);
  return report;
}

TEST(LayerGrowth, RatiosOfHeights) {
  BoundaryRefineOptions options;
  for (const double expansion : {1.0, 1.2, 2.0}) {
    options.expansion = expansion;
    const BoundaryRefineReport report = reportOf(block(), options);
    const double sum = 1 + expansion + expansion * expansion, last = expansion * expansion / sum / 3;
    int walls = 0;
    for (std::size_t i = 0; i < report.faces.layers.size(); ++i) {
      if (report.faces.layers[i] == 0) {
        EXPECT_EQ(report.faces.growthOutside[i], 0);
        continue;
      }
      ++walls;
      EXPECT_NEAR(report.faces.growthInside[i], expansion, 1e-9);
      EXPECT_NEAR(report.faces.growthOutside[i], 1 / last, 1e-9);
      EXPECT_NEAR(report.faces.firstHeight[i], report.faces.wantedFirst[i], 1e-12);
    }
    EXPECT_EQ(walls, 12);
    ASSERT_EQ(report.patches.size(), 1u);
    EXPECT_NEAR(report.patches[0].growthInside95, expansion, 1e-9);
    EXPECT_NEAR(report.patches[0].growthOutside, 1 / last, 1e-9);
    EXPECT_NEAR(report.patches[0].growthOutside95, 1 / last, 1e-9);
  }
}

TEST(LayerGrowth, OneLayerHasNoGrowthInside) {
  BoundaryRefineOptions options;
  options.layers = 1;
  const BoundaryRefineReport report = reportOf(block(), options);
  EXPECT_EQ(report.patches.at(0).growthInside95, 0);
  EXPECT_NEAR(report.patches.at(0).growthOutside, 3, 1e-9);
}

TEST(LayerGrowth, TheLastLayerThatFillsIsAStepInside) {
  BoundaryRefineOptions options;
  options.firstHeight = 0.02;
  const double last = 1.0 / 3 - 0.02 * 2.2;
  const BoundaryRefineReport filled = reportOf(block(), options);
  EXPECT_NEAR(filled.patches.at(0).growthInside95, last / 0.024, 1e-9);
  EXPECT_NEAR(filled.patches.at(0).growthOutside, 1 / last, 1e-9);
  options.end = LayerEnd::EvenGrowth;
  options.makeRoom = false;
  const BoundaryRefineReport even = reportOf(block(), options);
  const double ratio = even.patches.at(0).growthInside95;
  EXPECT_NEAR(0.02 * (1 + ratio + ratio * ratio), 1.0 / 3, 1e-9);
}

TEST(LayerGrowth, EvenGrowthDividesPrismAndCellBehindAnew) {
  // A prism of 1/3 on a cell of 1: layers and that cell are to be as a row of four, each 1.2 times the last.
  PolyMesh mesh = block();
  BoundaryRefineOptions options;
  options.end = LayerEnd::EvenGrowth;
  Monitor monitor;
  BoundaryRefineReport report;
  const PolyMesh refined = boundaryRefine(mesh, options, monitor, &report);
  EXPECT_EQ(checkTopology(refined), "");
  EXPECT_EQ(report.facesByLayers[2], 12);
  EXPECT_NEAR(report.patches.at(0).growthInside95, 1.2, 1e-9);
  EXPECT_NEAR(report.patches.at(0).growthOutside95, 1.2, 0.02);
  EXPECT_NEAR(report.patches.at(0).thickness, 4.0 / 3 * 3.64 / 5.368, 0.02);
  const auto volume = [](const PolyMesh& m) { return summarise(m, measure(m), {}).totalVolume; };
  EXPECT_NEAR(volume(refined), volume(mesh), 1e-12);
  options.makeRoom = false;  // then nothing below may move
  boundaryRefine(mesh, options, monitor, &report);
  EXPECT_NEAR(report.patches.at(0).thickness, 1.0 / 3, 1e-12);
}

TEST(LayerGrowth, AFarModelHasTheSame) {
  PolyMesh mesh = block();
  const double near = reportOf(mesh, {}).patches.at(0).growthOutside;
  for (Vec3& p : mesh.points) p = 1e-3 * p + Vec3(3, 1000, -70);
  mesh.finestSize *= 1e-3;
  EXPECT_NEAR(reportOf(mesh, {}).patches.at(0).growthOutside, near, 1e-6 * near);
}

TEST(LayerGrowth, HeightsAreThoseAboveTheWallWhereItBends) {
  // Around a cube prisms are wider at their lower end: volumes over the wall's area are no heights.
  const BoundaryRefineReport report = reportOf(layeredVoxels(cubeInBox()), {});
  int walls = 0;
  for (std::size_t i = 0; i < report.faces.layers.size(); ++i) {
    if (report.faces.layers[i] == 0) continue;
    ++walls;
    EXPECT_NEAR(report.faces.wantedFirst[i], 1 / 3.64 / 3, 1e-9);
    EXPECT_NEAR(report.faces.firstHeight[i], 1 / 3.64 / 3, 1e-9);
    EXPECT_NEAR(report.faces.thickness[i], 1.0 / 3, 1e-9);
  }
  EXPECT_EQ(walls, 6);
}

}  // namespace
