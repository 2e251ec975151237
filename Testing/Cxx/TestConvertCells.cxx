// SPDX-License-Identifier: BSD-3-Clause
// Finished meshes as tetrahedra and as standard cells.
#include "ConvertCells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "MeshQuality.h"
#include "Pipeline.h"
#include "TestMeshes.h"
#include "TestRooms.h"
#include "TestSurfaces.h"
#include "WallCuts.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr CellShapes kBoth[] = {CellShapes::Tetrahedra, CellShapes::Hybrid};

PolyMesh converted(const PolyMesh& mesh, CellShapes shapes, ConvertCellsReport* report = nullptr) {
  Monitor monitor;
  ConvertCellsOptions options;
  options.shapes = shapes;
  return convertCells(mesh, options, monitor, report);
}

/// Six times the volume of the tetrahedron on each triangle of a face's fan from its first point, about an
/// origin; independent of centres, exact for triangles.
double fanVolume(const PolyMesh& mesh, Id f, const Vec3& origin) {
  const Span<Id> row = mesh.faces[f];
  const auto at = [&](std::size_t i) { return Vec3(mesh.points[row[i]] - origin); };
  double sum = 0;
  for (std::size_t i = 1; i + 1 < row.size(); ++i) sum += at(0).dot(at(i).cross(at(i + 1)));
  return sum / 6;
}

struct NewCell {
  int triangles = 0, quads = 0, others = 0;
  std::set<Id> points;
  double volume = 0;
};

std::vector<NewCell> gatherCells(const PolyMesh& mesh) {
  std::vector<NewCell> cells(mesh.cellCount);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    for (int side = 0; side < (f < mesh.internalFaces() ? 2 : 1); ++side) {
      NewCell& cell = cells[side == 0 ? mesh.owner[f] : mesh.neighbour[f]];
      ++(row.size() == 3 ? cell.triangles : row.size() == 4 ? cell.quads : cell.others);
      cell.points.insert(row.begin(), row.end());
      cell.volume += (side == 0 ? 1 : -1) * fanVolume(mesh, f, mesh.points[0]);
    }
  }
  return cells;
}

void expectShapes(const PolyMesh& out, CellShapes shapes, const ConvertCellsReport& report) {
  Id tetrahedra = 0, pyramids = 0, wedges = 0, hexahedra = 0, unknown = 0, inverted = 0;
  for (const NewCell& cell : gatherCells(out)) {
    const auto is = [&](int triangles, int quads, std::size_t points) {
      return cell.triangles == triangles && cell.quads == quads && cell.others == 0 &&
             cell.points.size() == points;
    };
    ++(is(4, 0, 4)   ? tetrahedra
       : is(4, 1, 5) ? pyramids
       : is(2, 3, 6) ? wedges
       : is(0, 6, 8) ? hexahedra
                     : unknown);
    inverted += !(cell.volume > 0);
  }
  EXPECT_EQ(unknown, 0);
  EXPECT_EQ(inverted, 0);
  EXPECT_EQ(tetrahedra, report.tetrahedra);
  EXPECT_EQ(pyramids, report.pyramids);
  EXPECT_EQ(wedges, report.wedges);
  EXPECT_EQ(hexahedra, report.hexahedra);
  if (shapes == CellShapes::Tetrahedra) {
    EXPECT_EQ(tetrahedra, out.cellCount);
  }
}

/// No two faces with the same points: cells that overlap would have such.
void expectNoTwins(const PolyMesh& out) {
  std::set<std::vector<Id>> seen;
  Id twins = 0;
  for (Id f = 0; f < out.faceCount(); ++f) {
    std::vector<Id> row(out.faces[f].begin(), out.faces[f].end());
    std::sort(row.begin(), row.end());
    twins += !seen.insert(row).second;
  }
  EXPECT_EQ(twins, 0);
}

/// Of each patch: the sum of area vectors, which its rim alone decides, and the area of central triangles.
struct PatchArea {
  Vec3 vector = Vec3::Zero();
  double area = 0;
};
std::vector<PatchArea> patchAreas(const PolyMesh& mesh) {
  std::vector<PatchArea> patches(mesh.patchNames.size());
  for (Id b = 0; b < mesh.boundaryFaces(); ++b) {
    const Span<Id> row = mesh.faces[mesh.internalFaces() + b];
    const FaceMeasures face = measureFace(mesh.points, row);
    PatchArea& patch = patches[mesh.patch[b]];
    patch.vector += face.normal;
    for (std::size_t i = 0; i < row.size(); ++i)
      patch.area += 0.5 * (mesh.points[row[i]] - face.centre)
                              .cross(mesh.points[row[(i + 1) % row.size()]] - face.centre)
                              .norm();
  }
  return patches;
}

std::vector<double> zoneVolumes(const PolyMesh& mesh) {
  const MeshMeasures m = measure(mesh);
  std::vector<double> volumes(mesh.zoneNames.size(), 0.0);
  for (Id c = 0; c < Id(mesh.zone.size()); ++c) volumes[mesh.zone[c]] += m.cells[c].volume;
  return volumes;
}

/// Everything that holds whatever the mesh; tolerance: relative, of volumes and areas (warped wall faces are
/// cut).
void expectConverted(const PolyMesh& mesh, double tolerance) {
  const QualitySummary before = summarise(mesh, measure(mesh), {});
  for (CellShapes shapes : kBoth) {
    SCOPED_TRACE(shapes == CellShapes::Hybrid ? "hybrid" : "tetrahedra");
    ConvertCellsReport report;
    const PolyMesh out = converted(mesh, shapes, &report);
    EXPECT_EQ(checkTopology(out), "");
    EXPECT_EQ(out.stage, Stage::Refined);
    expectShapes(out, shapes, report);
    expectNoTwins(out);
    const MeshMeasures m = measure(out);
    const QualitySummary after = summarise(out, m, {});
    EXPECT_NEAR(after.totalVolume, report.volume, 1e-11 * before.totalVolume);
    EXPECT_NEAR(after.totalVolume, before.totalVolume, tolerance * before.totalVolume);
    EXPECT_GT(after.minTet, 0);
    EXPECT_GT(after.minPyramid, 0);
    EXPECT_LT(after.maxSkewInternal, 4);
    EXPECT_LT(after.maxSkewBoundary, 4);
    EXPECT_NEAR(std::max(after.maxSkewInternal, after.maxSkewBoundary), report.maxSkewness, 1e-5);
    EXPECT_EQ(out.patchNames, mesh.patchNames);
    const std::vector<PatchArea> areas = patchAreas(out), wanted = patchAreas(mesh);
    for (std::size_t i = 0; i < areas.size(); ++i) {
      EXPECT_LE((areas[i].vector - wanted[i].vector).norm(), 1e-12 * wanted[i].area);
      EXPECT_NEAR(areas[i].area, wanted[i].area, tolerance * wanted[i].area);
    }
    const std::vector<double> zones = zoneVolumes(out), whole = zoneVolumes(mesh);
    ASSERT_EQ(zones.size(), whole.size());
    for (std::size_t i = 0; i < zones.size(); ++i) EXPECT_NEAR(zones[i], whole[i], tolerance * whole[i]);
    EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), out.points.begin()));
    EXPECT_EQ(Id(out.points.size()), Id(mesh.points.size()) + report.cellCentres + report.faceCentres);
    PolyMesh again = out;
    canonicalise(again);
    EXPECT_EQ(checksum(again), checksum(out));
  }
}

PolyMesh meshed(const SurfaceModel& model, double size, int layers, const PipelineOptions& base = {}) {
  Monitor monitor;
  PipelineOptions o = base;
  o.octree.featureSize = size;
  o.refine.layers = layers;
  return runPipeline(model, o, monitor);
}

/// Cubes of two sizes and more around a unit cube, all faces flat.
PolyMesh levels() {
  PipelineOptions o;
  o.octree.baseSize = 0.5;
  o.octree.useDomain = true;
  o.octree.domain.add(Vec3(-1, -1, -1));
  o.octree.domain.add(Vec3(2, 2, 2));
  o.front.region = Region::Outside;
  o.stopAfter = Stage::Front;
  return meshed(*cube().model(), 0.125, 1, o);
}

Soup sphereSoup() {
  return cube(12).mapped([](const Vec3& p) { return Vec3((p - Vec3::Constant(0.5)).normalized()); });
}

/// A cube that stands askew to the octree: feature edges cut wall faces.
Soup askew() {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return cube(2, true).mapped([&](const Vec3& p) { return Vec3(turn * p); });
}

TEST(ConvertCells, LevelJumpsKeepVolumesAndAreasExactly) {
  const PolyMesh mesh = levels();
  ASSERT_GT(std::set<int>(mesh.level.begin(), mesh.level.end()).size(), 1u);
  expectConverted(mesh, 1e-12);
}

TEST(ConvertCells, SphereWithLayers) {
  const auto model = sphereSoup().model();
  for (int layers : {1, 4}) expectConverted(meshed(*model, 0.2, layers), 2e-3);
}

TEST(ConvertCells, CutWallFaces) {
  const auto model = askew().model();
  for (int layers : {1, 3}) expectConverted(meshed(*model, 0.1, layers), 2e-3);
  PolyMesh mesh = layeredVoxels(cubeInBox());  // every second wall face of it cut by hand
  std::vector<WallCut> cuts;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); f += 2) {
    const Span<Id> row = mesh.faces[f];
    if (mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()])) cuts.push_back({f, row[0], row[2]});
  }
  cutWallFaces(mesh, cuts);
  canonicalise(mesh);
  expectConverted(mesh, 1e-12);
}

TEST(ConvertCells, ZonesStay) {
  PipelineOptions o;
  o.front.region = Region::Enclosed;
  const auto model =
      rooms({{{0, 1, 2}, {0, 1}, {0, 1}}}, 2, [](const Vec3& p) { return p[0] < 1 ? 1 : 2; }).model();
  const PolyMesh mesh = meshed(*model, 0.2, 2, o);
  ASSERT_EQ(mesh.zoneNames.size(), 2u);
  expectConverted(mesh, 1e-3);
}

TEST(ConvertCells, AHexahedronIsSixTetrahedraWithoutANewPoint) {
  const CellFaces faces = prism({0, 1, 2, 3}, {4, 5, 6, 7});
  const PolyMesh mesh =
      joinCells({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                {faces}, {"wall"}, {"wall"}, [](const Face&) { return 0; });
  ConvertCellsReport report;
  const PolyMesh out = converted(mesh, CellShapes::Tetrahedra, &report);
  EXPECT_EQ(out.cellCount, 6);
  EXPECT_EQ(out.points.size(), 8u);
  for (const NewCell& cell : gatherCells(out)) EXPECT_NEAR(cell.volume, 1.0 / 6, 1e-15);  // Kuhn's
  const PolyMesh whole = converted(mesh, CellShapes::Hybrid, &report);
  EXPECT_EQ(report.cellsThatStay, 1);
  EXPECT_EQ(report.hexahedra, 1);
  EXPECT_EQ(whole.faces.values, mesh.faces.values);
}

TEST(ConvertCells, UniformCubesAreSixTetrahedraEach) {
  VoxelOptions o;
  const PolyMesh mesh = layeredVoxels(o);
  ConvertCellsReport report;
  const PolyMesh out = converted(mesh, CellShapes::Tetrahedra, &report);
  EXPECT_EQ(out.cellCount, 6 * mesh.cellCount);
  EXPECT_EQ(report.cellCentres + report.faceCentres, 0);
  expectConverted(mesh, 1e-12);
}

/// A square and a pentagon, each with a cell below and a prism above: the pentagon's become wedges.
TEST(ConvertCells, HybridCutsPrismsOverPolygonsIntoWedges) {
  const PolyMesh mesh = layeredPolygons({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}, {2.8, 0.5}},
                                        {{0, 1, 4, 5}, {1, 2, 6, 3, 4}}, 0.3);
  ConvertCellsReport report;
  const PolyMesh out = converted(mesh, CellShapes::Hybrid, &report);
  EXPECT_EQ(report.cellsThatStay, 2);
  EXPECT_EQ(report.hexahedra, 2);
  EXPECT_EQ(report.wedges, 2 * 3);
  EXPECT_EQ(out.cellCount, 8);
  EXPECT_EQ(out.points.size(), mesh.points.size());
  expectConverted(mesh, 1e-12);
}

/// Cubes beside smaller ones are cut into pyramids and tetrahedra; all others stay.
TEST(ConvertCells, HybridCutsOnlyWhatIsNoStandardCell) {
  const PolyMesh mesh = levels();
  Id cubes = 0;
  for (const NewCell& cell : gatherCells(mesh))
    cubes += cell.quads == 6 && cell.triangles + cell.others == 0 && cell.points.size() == 8;
  ASSERT_GT(cubes, 0);
  ASSERT_LT(cubes, mesh.cellCount);
  ConvertCellsReport report;
  converted(mesh, CellShapes::Hybrid, &report);
  EXPECT_EQ(report.cellsThatStay, cubes);
  EXPECT_EQ(report.hexahedra, cubes);
  EXPECT_LE(report.cellCentres, mesh.cellCount - cubes);
  EXPECT_EQ(report.faceCentres, 0);
  EXPECT_GT(report.pyramids, 0);
}

TEST(ConvertCells, HybridKeepsLayersAsTheyAre) {
  const PolyMesh mesh = meshed(*sphereSoup().model(), 0.2, 4);
  ConvertCellsReport report;
  const PolyMesh out = converted(mesh, CellShapes::Hybrid, &report);
  const auto layered = [](const PolyMesh& m) {
    return m.cellCount - std::count(m.layer.begin(), m.layer.end(), 0);
  };
  EXPECT_GT(report.cellsThatStay, 0.9 * mesh.cellCount - layered(mesh) * 0.1);
  EXPECT_LT(out.cellCount, 3 * mesh.cellCount);
  EXPECT_LT(report.nonOrthogonalFaces, converted(mesh, CellShapes::Tetrahedra).cellCount / 100);
  for (std::size_t p = 0; p < out.points.size(); ++p) EXPECT_EQ(out.base[p], kNone);
}

TEST(ConvertCells, SameBitsForAnyNumberOfThreads) {
  const PolyMesh mesh = meshed(*askew().model(), 0.1, 2);
  for (CellShapes shapes : kBoth) {
    std::uint64_t sums[2];
    for (int threads : {1, 4})
      withThreads(threads, [&] { sums[threads > 1] = checksum(converted(mesh, shapes)); });
    EXPECT_EQ(sums[0], sums[1]);
  }
}

TEST(ConvertCells, RefusesACellTurnedInsideOut) {
  PolyMesh mesh = layeredVoxels({});
  for (Vec3& p : mesh.points)
    if (p == Vec3(1, 1, 1)) p = Vec3(2.5, 2.5, 2.5);
  try {
    converted(mesh, CellShapes::Tetrahedra);
    FAIL() << "a cell has negative volume";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cannot be cut into cells of positive volume"),
              std::string::npos)
        << error.what();
  }
}

TEST(ConvertCells, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(convertCells(levels(), {}, stop), AbortError);
}

}  // namespace
