// SPDX-License-Identifier: BSD-3-Clause
#include "MeshQualityReport.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

#include "TestMeshes.h"

namespace pm {
namespace {

const double kPi = std::acos(-1.0);

/// Voxels without layers.
PolyMesh voxels(std::array<int, 3> size, const std::function<Vec3(const Vec3&)>& deform) {
  testing::VoxelOptions o;
  o.size = size;
  o.wallSide.fill(false);
  o.deform = deform;
  return testing::layeredVoxels(o);
}

Vec3 asItIs(const Vec3& p) { return p; }

MeshQualityReport reportOn(const PolyMesh& mesh, const MeshQualityReportOptions& options = {}) {
  Monitor monitor;
  return reportMeshQuality(mesh, options, monitor);
}

void expectAll(const QualityMeasure& m, double value, double tolerance = 1e-12) {
  ASSERT_FALSE(m.values.empty()) << m.name;
  for (double v : m.values) ASSERT_NEAR(v, value, tolerance) << m.name;
  EXPECT_NEAR(m.mean, value, tolerance) << m.name;
}

Span<Id> span(const std::vector<Id>& row) { return {row.data(), row.data() + row.size()}; }

TEST(MeshQualityReport, Cubes) {
  const PolyMesh mesh = voxels({3, 3, 3}, asItIs);
  const MeshQualityReport r = reportOn(mesh);
  for (const char* name : {"NonOrthogonality", "SkewInternal", "SkewBoundary", "FaceConcavity", "Openness"})
    expectAll(r.measure(name), 0, 1e-5);
  for (const char* name : {"VolumeRatio", "FaceArea", "Flatness", "AspectRatio", "Volume"})
    expectAll(r.measure(name), 1);
  expectAll(r.measure("FaceWeight"), 0.5);
  expectAll(r.measure("CellConcavity"), -45, 1e-9);  // from a side's centre to the next side's
  EXPECT_EQ(r.concaveCells, 0);
  // 1/8 of the product of internal faces along x, y, z: corners, edges, sides, the middle.
  std::vector<double> found = r.measure("Determinant").values;
  std::sort(found.begin(), found.end());
  for (int i = 0; i < 27; ++i) EXPECT_NEAR(found[i], i < 8 ? 0.125 : i < 20 ? 0.25 : i < 26 ? 0.5 : 1, 1e-12);
  for (const QualityMeasure& m : r.measures) EXPECT_EQ(m.outside, 0) << m.name;
  EXPECT_TRUE(facesOutside(r).empty());
}

TEST(MeshQualityReport, ShearTurnsTheNonOrthogonality) {
  const double shear = 3;
  const PolyMesh mesh =
      voxels({1, 1, 3}, [&](const Vec3& p) { return Vec3(p.x() + shear * p.z(), p.y(), p.z()); });
  const MeshQualityReport r = reportOn(mesh);
  const QualityMeasure& angle = r.measure("NonOrthogonality");
  expectAll(angle, std::atan(shear) * 180 / kPi, 1e-9);
  EXPECT_EQ(angle.outside, 2);
  EXPECT_GE(facesOutside(r).size(), 2u);
  expectAll(r.measure("FaceWeight"), 0.5);
}

TEST(MeshQualityReport, StretchedCells) {
  const PolyMesh mesh = voxels(
      {2, 2, 2}, [](const Vec3& p) { return Vec3(p.x(), p.y(), p.z() <= 1 ? p.z() : 1 + 4 * (p.z() - 1)); });
  MeshQualityReportOptions options;
  options.foam.maxAspectRatio = 3.9;
  const MeshQualityReport r = reportOn(mesh, options);
  const QualityMeasure &aspect = r.measure("AspectRatio"), &ratio = r.measure("VolumeRatio"),
                       &weight = r.measure("FaceWeight");
  EXPECT_EQ(aspect.outside, 4);
  EXPECT_EQ(std::count_if(aspect.values.begin(), aspect.values.end(),
                          [](double v) { return std::abs(v - 4) < 1e-12; }),
            4);
  for (const QualityMeasure* m : {&ratio, &weight}) {
    const double across = m == &ratio ? 0.25 : 0.5 / 2.5;
    EXPECT_EQ(std::count_if(m->values.begin(), m->values.end(),
                            [&](double v) { return std::abs(v - across) < 1e-12; }),
              4)
        << m->name;
  }
  options.solved = {true, true, false};
  expectAll(reportOn(mesh, options).measure("AspectRatio"), 1);
}

TEST(FoamQuality, HydraulicAspectRatioOfARotatedPlate) {
  // Turned by 45 degrees the sums along the axes are nearly alike; the area over the volume still tells.
  const double thin = 0.01;
  const PolyMesh mesh = voxels({1, 1, 1}, [&](const Vec3& p) {
    return Vec3((p.x() - thin * p.z()) / std::sqrt(2.0), p.y(), (p.x() + thin * p.z()) / std::sqrt(2.0));
  });
  const double sums = 2 * std::sqrt(2.0) * (1 + thin) + 2 * thin;
  expectAll(reportOn(mesh).measure("AspectRatio"),
            std::max((std::sqrt(2.0) * (1 + thin)) / (2 * thin), sums / 6 / std::pow(thin, 2.0 / 3)), 1e-9);
}

TEST(FoamQuality, FlatnessOfASaddle) {
  const double h = 0.3;
  const std::vector<Vec3> points{{0, 0, h}, {1, 0, -h}, {1, 1, h}, {0, 1, -h}};
  const std::vector<Id> square{0, 1, 2, 3}, triangle{0, 1, 2};
  EXPECT_NEAR(faceFlatness(points, span(square), measureFace(points, span(square))),
              1 / std::sqrt(1 + 4 * h * h), 1e-14);
  EXPECT_EQ(faceFlatness(points, span(triangle), measureFace(points, span(triangle))), 1);
}

TEST(FoamQuality, ConcavityIsTheTurnInwards) {
  const double dip = std::tan(10 * kPi / 180);
  const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1 - dip, 0}, {0, 1, 0}};
  const std::vector<Id> dented{0, 1, 2, 3, 4}, convex{0, 1, 2, 4};
  EXPECT_NEAR(faceConcavity(points, span(dented), measureFace(points, span(dented))), 20, 1e-9);
  EXPECT_EQ(faceConcavity(points, span(convex), measureFace(points, span(convex))), 0);
}

TEST(FoamQuality, TetrahedraAreMeasuredByTheirSphere) {
  const Vec3 a(1, 1, 1), b(-1, -1, 1), c(-1, 1, -1), d(1, -1, -1);
  EXPECT_NEAR(std::abs(tetQuality(a, b, c, d)), 1, 1e-14);
  EXPECT_NEAR(tetQuality(a, b, c, d), -tetQuality(b, a, c, d), 1e-14);
  // A cube's corner: volume 1/6, circumsphere the cube's own.
  const Vec3 o = Vec3::Zero();
  EXPECT_NEAR(tetQuality(o, Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()), 0.5, 1e-14);
  EXPECT_NEAR(tetQuality(o, Vec3::UnitX(), Vec3::UnitY(), Vec3(1, 1, 0)), 0, 1e-14);
}

TEST(FoamQuality, FaceTetsOfCubesAndOfAFoldedCell) {
  const PolyMesh cubes = voxels({2, 1, 1}, asItIs);
  const double half = std::sqrt(0.5);
  // About a face's centre: base 1, apex the cube's centre; all four tetrahedra alike.
  const double central = tetQuality(Vec3(0.5, 0.5, 0), Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0.5, 0.5, 0.5));
  const double fan = tetQuality(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0.5, 0.5, 0.5));
  EXPECT_LT(std::abs(central), half);
  const MeshQualityReport r = reportOn(cubes);
  for (double v : r.measure("FaceTet").values)
    EXPECT_NEAR(v, std::min(std::abs(central), std::abs(fan)), 1e-12);
  PolyMesh folded = cubes;
  for (Vec3& p : folded.points) {
    if (p == Vec3(2, 1, 1)) p = Vec3(-1, -1, -1);
  }
  const QualityMeasure m = reportOn(folded).measure("FaceTet");
  EXPECT_LT(*std::min_element(m.values.begin(), m.values.end()), 0);
  EXPECT_GT(m.outside, 0);
}

TEST(MeshQualityReport, ConcaveCellOfAnL) {
  std::vector<Vec3> points;
  for (double z : {0.0, 1.0}) {
    for (const auto& p :
         {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(1, 1, 0), Vec3(1, 2, 0), Vec3(0, 2, 0)})
      points.push_back(p + Vec3(0, 0, z));
  }
  const PolyMesh mesh = testing::joinCells(points, {testing::prism({0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11})},
                                           {"all"}, {"patch"}, [](const testing::Face&) { return 0; });
  const MeshQualityReport r = reportOn(mesh);
  expectAll(r.measure("CellConcavity"), 45, 1e-9);
  EXPECT_EQ(r.concaveCells, 1);
  EXPECT_EQ(r.measure("FaceConcavity").outside, 2);  // bottom and top
  EXPECT_EQ(r.measure("AngleBoundary").outside, 2);  // the inner sides lie aslant of the centre
  EXPECT_EQ(facesOutside(r).size(), 4u);
}

PolyMesh wavy() {
  return voxels({6, 5, 4}, [](const Vec3& p) {
    return Vec3(p +
                0.12 * Vec3(std::sin(3 * p.y()), std::cos(2 * p.z() + p.x()), std::sin(p.x() + 2 * p.y())));
  });
}

TEST(MeshQualityReport, WorstPlacesAreTheWorst) {
  const PolyMesh mesh = wavy();
  MeshQualityReportOptions options;
  options.worstPlaces = 7;
  const MeshQualityReport r = reportOn(mesh, options);
  ASSERT_EQ(r.places.size(), 7 * r.measures.size());
  for (std::size_t i = 0; i < r.places.size(); ++i) {
    const QualityPlace& p = r.places[i];
    const QualityMeasure& m = r.measures[p.measure];
    ASSERT_EQ(p.measure, static_cast<Id>(i / 7));
    std::vector<double> values = m.values;
    std::sort(values.begin(), values.end());
    ASSERT_EQ(p.value, m.upper ? values[values.size() - 1 - i % 7] : values[i % 7]) << m.name;
    const Id id = m.ofCells ? p.cell : p.face;
    ASSERT_EQ(p.value, m.values[id - m.first]);
    ASSERT_EQ(p.patch != kNone, !m.ofCells && p.face >= mesh.internalFaces());
    if (!m.ofCells) ASSERT_EQ(p.cell, mesh.owner[p.face]);
  }
}

TEST(MeshQualityReport, HistogramsCountEveryValue) {
  const MeshQualityReport r = reportOn(wavy());
  ASSERT_EQ(r.histograms.size(), r.measures.size());
  for (std::size_t i = 0; i < r.measures.size(); ++i) {
    const QualityHistogram& h = r.histograms[i];
    ASSERT_EQ(h.edges.size(), h.counts.size() + 1);
    EXPECT_EQ(std::accumulate(h.counts.begin(), h.counts.end(), std::size_t(0)), r.measures[i].values.size());
    EXPECT_TRUE(std::is_sorted(h.edges.begin(), h.edges.end())) << r.measures[i].name;
  }
}

TEST(MeshQualityReport, HistogramBins) {
  const QualityHistogram equal = histogram({0, 1, 2, 3, 4, 4}, 4);
  EXPECT_EQ(equal.counts, (std::vector<Id>{1, 1, 1, 3}));
  EXPECT_EQ(equal.edges, (std::vector<double>{0, 1, 2, 3, 4}));
  const QualityHistogram ratios = histogram({1, 20, 300, 1e4}, 4);
  EXPECT_EQ(ratios.counts, (std::vector<Id>{1, 1, 1, 1}));
  EXPECT_NEAR(ratios.edges[2], 100, 1e-9);
  EXPECT_EQ(histogram({5, 5}, 3).counts, (std::vector<Id>{2, 0, 0}));
  EXPECT_EQ(histogram({std::nan(""), 1, 2}, 2).counts, (std::vector<Id>{1, 1}));
  EXPECT_EQ(histogram({}, 2).counts, (std::vector<Id>{0, 0}));
}

TEST(MeshQualityReport, CellsGetTheWorstOfTheirFaces) {
  const PolyMesh mesh = wavy();
  const MeshQualityReport r = reportOn(mesh);
  const QualityMeasure& angle = r.measure("NonOrthogonality");
  const std::vector<float> worst = worstOfCells(mesh, angle);
  std::vector<float> expected(mesh.cellCount, 0);
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    for (Id c : {mesh.owner[f], mesh.neighbour[f]})
      expected[c] = std::max(expected[c], static_cast<float>(angle.values[f]));
  }
  EXPECT_EQ(worst, expected);
  const std::vector<float> outer = worstOfCells(mesh, r.measure("SkewBoundary"));
  EXPECT_EQ(std::count_if(outer.begin(), outer.end(), [](float v) { return std::isnan(v); }), 4 * 3 * 2);
}

TEST(MeshQualityReport, AgreesWithWhatTheStagesKeep) {
  const PolyMesh mesh = wavy();
  const MeshQualityReport r = reportOn(mesh);
  const QualitySummary q = summarise(mesh, measure(mesh), QualityLimits());
  const auto extreme = [&](const char* name, bool largest) {
    const std::vector<double>& v = r.measure(name).values;
    return largest ? *std::max_element(v.begin(), v.end()) : *std::min_element(v.begin(), v.end());
  };
  EXPECT_EQ(extreme("Volume", false), q.minVolume);
  EXPECT_EQ(extreme("CentralTet", false), q.minTet);
  EXPECT_EQ(extreme("FacePyramid", false), q.minPyramid);
  EXPECT_EQ(extreme("AngleInternal", true), q.maxAngleInternal);
  EXPECT_EQ(extreme("Warpage", true), q.maxWarpage);
  EXPECT_EQ(static_cast<float>(extreme("SkewInternal", true)), static_cast<float>(q.maxSkewInternal));
}

TEST(MeshQualityReport, SameBitsForAnyNumberOfThreads) {
  const PolyMesh mesh = wavy();
  const MeshQualityReport many = reportOn(mesh);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const MeshQualityReport single = reportOn(mesh);
  for (std::size_t i = 0; i < many.measures.size(); ++i) {
    EXPECT_EQ(many.measures[i].values, single.measures[i].values);
    EXPECT_EQ(many.measures[i].mean, single.measures[i].mean);
  }
}

TEST(MeshQualityReport, UnknownMeasure) {
  EXPECT_THROW(MeshQualityReport().measure("Beauty"), InternalError);
}

}  // namespace
}  // namespace pm
