// SPDX-License-Identifier: BSD-3-Clause
// The far field: columns of cells from the domain's sides to a far box or sphere.
#include "FarField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "Pipeline.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr std::array<bool, 6> kAll{true, true, true, true, true, true};
constexpr std::array<bool, 6> kNotGround{true, true, true, true, false, true};

Box box(const Vec3& lo, const Vec3& hi) {
  Box b;
  b.add(lo);
  b.add(hi);
  return b;
}

/// A unit cube in a domain, meshed outside.
PolyMesh cubeIn(const Box& domain, Stage last, double base = 0.5) {
  Monitor monitor;
  PipelineOptions o;
  o.octree.featureSize = 0.25;
  o.octree.baseSize = base;
  o.octree.useDomain = true;
  o.octree.domain = domain;
  o.front.region = Region::Outside;
  o.stopAfter = last;
  return runPipeline(*cube().model(), o, monitor);
}
PolyMesh cubeInBox(Stage last = Stage::Front) { return cubeIn(box({-1, -1, -1}, {2, 2, 2}), last); }

FarFieldOptions toBox(const Vec3& lo, const Vec3& hi, std::array<bool, 6> extend = kAll) {
  FarFieldOptions o;
  o.useBounds = true;
  o.bounds = box(lo, hi);
  o.extend = extend;
  return o;
}
FarFieldOptions toSphere(double radius, std::array<bool, 6> extend = kAll) {
  FarFieldOptions o;
  o.shape = FarShape::Sphere;
  o.radius = radius;
  o.extend = extend;
  return o;
}

PolyMesh extended(const PolyMesh& mesh, const FarFieldOptions& options, FarFieldReport* report = nullptr) {
  Monitor monitor;
  return farField(mesh, options, monitor, report);
}

double volumeOf(const PolyMesh& mesh) { return summarise(mesh, measure(mesh), {}).totalVolume; }

Id patchNamed(const PolyMesh& mesh, const std::string& name) {
  const auto found = std::find(mesh.patchNames.begin(), mesh.patchNames.end(), name);
  return found == mesh.patchNames.end() ? kNone : static_cast<Id>(found - mesh.patchNames.begin());
}

template <class Body>
void forEachFaceOf(const PolyMesh& mesh, const std::string& patch, const Body& body) {
  const Id wanted = patchNamed(mesh, patch);
  for (Id b = 0; b < mesh.boundaryFaces(); ++b)
    if (mesh.patch[b] == wanted) body(mesh.internalFaces() + b);
}

double areaOf(const PolyMesh& mesh, const std::string& patch) {
  double area = 0;
  forEachFaceOf(mesh, patch, [&](Id f) { area += measureFace(mesh.points, mesh.faces[f]).normal.norm(); });
  return area;
}

/// points - edges + faces - cells.
long eulerNumber(const PolyMesh& mesh) {
  std::set<std::pair<Id, Id>> edges;
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Id p = row[i], q = row[(i + 1) % row.size()];
      edges.emplace(std::min(p, q), std::max(p, q));
    }
  }
  return long(mesh.points.size()) - long(edges.size()) + mesh.faceCount() - mesh.cellCount;
}

/// Everything a far field promises whatever its shape.
void expectGood(const PolyMesh& inner, const PolyMesh& outer, const FarFieldReport& report) {
  EXPECT_EQ(checkTopology(outer), "");
  EXPECT_EQ(eulerNumber(outer), eulerNumber(inner));
  EXPECT_EQ(outer.stage, inner.stage);
  EXPECT_EQ(outer.cellCount, inner.cellCount + report.cells);
  EXPECT_TRUE(std::equal(inner.points.begin(), inner.points.end(), outer.points.begin()));
  EXPECT_TRUE(std::equal(inner.level.begin(), inner.level.end(), outer.level.begin()));
  EXPECT_TRUE(std::equal(inner.layer.begin(), inner.layer.end(), outer.layer.begin()));
  EXPECT_EQ(std::count(outer.layer.begin() + inner.cellCount, outer.layer.end(), 0), report.cells);
  const MeshMeasures m = measure(outer), before = measure(inner);
  const QualitySummary q = summarise(outer, m, {});
  EXPECT_EQ(q.violations, summarise(inner, before, {}).violations) << describeViolations(outer, m, {});
  for (Id c = 0; c < outer.cellCount; ++c) EXPECT_GT(m.cells[c].volume, 0);
  EXPECT_NEAR(q.totalVolume, volumeOf(inner) + report.volume, 1e-9 * q.totalVolume);
}

TEST(FarField, BoxFillsTheGapExactly) {
  const PolyMesh inner = cubeInBox();
  FarFieldReport report;
  const PolyMesh outer = extended(inner, toBox({-5, -5, -5}, {6, 6, 6}), &report);
  expectGood(inner, outer, report);
  EXPECT_NEAR(report.volume, 11 * 11 * 11 - 27, 1e-9);
  EXPECT_EQ(report.steps, 1);
  EXPECT_EQ(report.cells, report.layers * 6 * 36);  // 6 x 6 cells on each side of the domain
  EXPECT_LT(report.maxAngle, 55);
  for (int s = 0; s < 6; ++s) {
    const std::string name{"xyz"[s / 2], 'm', s % 2 ? 'a' : 'i', s % 2 ? 'x' : 'n'};
    EXPECT_NEAR(areaOf(outer, name), 121, 1e-9);
    forEachFaceOf(outer, name, [&](Id f) {
      for (Id p : outer.faces[f]) {
        EXPECT_EQ(outer.points[p][s / 2], s % 2 ? 6 : -5);
        EXPECT_TRUE(outer.fixed[p] >> s / 2 & 1);
      }
    });
  }
}

TEST(FarField, FinishedMeshStaysValid) {
  const PolyMesh inner = cubeInBox(Stage::Refined);
  for (const FarFieldOptions& o : {toBox({-5, -5, -5}, {6, 6, 6}), toSphere(9)}) {
    FarFieldReport report;
    const PolyMesh outer = extended(inner, o, &report);
    expectGood(inner, outer, report);
  }
}

TEST(FarField, SidesThatStayAreFlatAndWhole) {
  const PolyMesh inner = cubeInBox();
  FarFieldReport report;
  const PolyMesh outer = extended(inner, toBox({-5, -5, 0}, {6, 6, 6}, kNotGround), &report);
  expectGood(inner, outer, report);
  EXPECT_NEAR(report.volume, 11 * 11 * 7 - 27, 1e-9);
  EXPECT_NEAR(areaOf(outer, "zmin"), 121, 1e-9);
  EXPECT_NEAR(areaOf(outer, "xmax"), 11 * 7, 1e-9);
  forEachFaceOf(outer, "zmin", [&](Id f) {
    for (Id p : outer.faces[f]) {
      EXPECT_EQ(outer.points[p][2], -1);
      EXPECT_TRUE(outer.fixed[p] & 4);
    }
  });
  for (std::size_t p = 0; p < outer.points.size(); ++p) {  // the old sides are inside now
    if (outer.points[p][0] == 2 && outer.points[p][2] > -1) {
      EXPECT_EQ(outer.fixed[p] & 1, 0);
    }
  }
}

TEST(FarField, AChannelGoesStraightOnAndGrowsByTheRatio) {
  const PolyMesh inner = cubeInBox();
  FarFieldOptions o = toBox({0, 0, 0}, {14, 0, 0}, {false, true, false, false, false, false});
  o.expansionRatio = 1.3;
  FarFieldReport report;
  o.bounds.lo = Vec3(-9, -9, -9);
  o.bounds.hi = Vec3(14, 9, 9);
  const PolyMesh outer = extended(inner, o, &report);
  EXPECT_EQ(checkTopology(outer), "");
  EXPECT_NEAR(report.volume, 9 * 12, 1e-9);
  EXPECT_NEAR(report.maxAngle, 0, 1e-4);
  std::set<double> planes;
  for (const Vec3& p : outer.points)
    if (p[0] >= 2) planes.insert(p[0]);
  ASSERT_EQ(int(planes.size()), report.layers + 1);
  EXPECT_EQ(*planes.rbegin(), 14);
  double last = 0;
  for (auto x = planes.begin(); std::next(x) != planes.end(); ++x) {
    const double thickness = *std::next(x) - *x;
    if (last > 0) {
      EXPECT_LE(thickness, 1.3 * last * (1 + 1e-9));
    } else {
      EXPECT_NEAR(thickness, 0.5, 1e-6);  // as the cells of the domain
    }
    last = thickness;
  }
}

TEST(FarField, ASphereIsRoundAndConverges) {
  double missing[2];
  for (int i = 0; i < 2; ++i) {
    const PolyMesh inner = cubeIn(box({-1, -1, -1}, {2, 2, 2}), Stage::Front, i == 0 ? 0.5 : 0.25);
    FarFieldReport report;
    const PolyMesh outer = extended(inner, toSphere(8), &report);
    expectGood(inner, outer, report);
    EXPECT_EQ(patchNamed(outer, "xmin"), kNone);
    EXPECT_EQ(outer.patchTypes[patchNamed(outer, "far")], "patch");
    int faces = 0;
    forEachFaceOf(outer, "far", [&](Id f) {
      ++faces;
      for (Id p : outer.faces[f]) {
        EXPECT_NEAR((outer.points[p] - Vec3(0.5, 0.5, 0.5)).norm(), 8, 1e-12);
        EXPECT_EQ(outer.fixed[p], 7);
      }
    });
    EXPECT_EQ(faces * report.layers, report.cells);
    missing[i] = 4.0 / 3 * M_PI * 512 - 27 - report.volume;
  }
  EXPECT_GT(missing[1], 0);
  EXPECT_NEAR(missing[0] / missing[1], 4, 0.4);  // chords: second order
}

TEST(FarField, HalfSphereOnTheGroundAndCylinderBetweenSides) {
  const PolyMesh inner = cubeInBox();
  FarFieldReport report;
  const PolyMesh half = extended(inner, toSphere(9, kNotGround), &report);
  expectGood(inner, half, report);
  EXPECT_NEAR(report.volume / (2.0 / 3 * M_PI * 729 - 27), 1, 0.03);
  EXPECT_NEAR(areaOf(half, "zmin") / (M_PI * 81), 1, 0.03);
  forEachFaceOf(half, "zmin", [&](Id f) {
    for (Id p : half.faces[f]) EXPECT_EQ(half.points[p][2], -1);
  });
  forEachFaceOf(half, "far", [&](Id f) {
    for (Id p : half.faces[f]) EXPECT_NEAR((half.points[p] - Vec3(0.5, 0.5, -1)).norm(), 9, 1e-12);
  });

  const PolyMesh cylinder = extended(inner, toSphere(9, {true, true, true, true, false, false}), &report);
  expectGood(inner, cylinder, report);
  EXPECT_NEAR(report.volume / (M_PI * 81 * 3 - 27), 1, 0.03);
  forEachFaceOf(cylinder, "far", [&](Id f) {
    for (Id p : cylinder.faces[f])
      EXPECT_NEAR((cylinder.points[p] - Vec3(0.5, 0.5, cylinder.points[p][2])).norm(), 9, 1e-12);
  });
}

TEST(FarField, VeryDifferentDistancesAreBridgedInSteps) {
  const PolyMesh inner = cubeIn(box({-1, -1, -1}, {3, 2, 2}), Stage::Refined);
  FarFieldReport report;
  const PolyMesh outer = extended(inner, toBox({-3, -4, -1}, {23, 5, 6}, kNotGround), &report);
  EXPECT_GT(report.steps, 1);
  expectGood(inner, outer, report);
  EXPECT_NEAR(report.volume, 26 * 9 * 7 - 36, 1e-9);
  EXPECT_LE(report.growth, 1.2 + 1e-9);
  EXPECT_LT(report.maxAngle, 66.2);
  EXPECT_NEAR(areaOf(outer, "xmax"), 63, 1e-9);
  EXPECT_NEAR(areaOf(outer, "zmin"), 26 * 9, 1e-9);
}

TEST(FarField, LongDomainsShearNoMoreThanACube) {
  const PolyMesh inner = cubeIn(box({-1, -1, -1}, {15, 2, 2}), Stage::Front);
  FarFieldOptions o;
  o.distance = 4;
  FarFieldReport report;
  expectGood(inner, extended(inner, o, &report), report);
  EXPECT_LT(report.maxAngle, 55);  // from the centre alone the corner's would be 75
}

TEST(FarField, TheChainGoesOnFromIt) {
  const auto model = cube().model();
  const PolyMesh far = extended(cubeInBox(Stage::Front), toBox({-5, -5, -5}, {6, 6, 6}));
  Monitor monitor;
  PolyMesh mesh = dummyLayer(far, {}, monitor);
  DistanceField field(*model, mesh.finestSize);
  project(mesh, field, {}, monitor);
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(summarise(mesh, measure(mesh), {}).violations, 0);
  EXPECT_NEAR(volumeOf(mesh), 11 * 11 * 11 - 1, 0.2);
  EXPECT_NEAR(areaOf(mesh, "xmin"), 121, 1e-9);
}

TEST(FarField, SameBitsForAnyNumberOfThreadsAndCanonical) {
  const PolyMesh inner = cubeInBox();
  std::uint64_t sums[2];
  for (int threads : {1, 4})
    withThreads(threads, [&] { sums[threads > 1] = checksum(extended(inner, toSphere(8))); });
  EXPECT_EQ(sums[0], sums[1]);
  PolyMesh again = extended(inner, toSphere(8));
  canonicalise(again);
  EXPECT_EQ(checksum(again), sums[0]);
}

/// The sentence with which the call refuses; empty when it does not.
std::string refusal(const PolyMesh& mesh, const FarFieldOptions& options) {
  try {
    extended(mesh, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(FarField, RefusesWhatCannotBe) {
  const PolyMesh inner = cubeInBox();
  const auto expectRefused = [&](FarFieldOptions o, const std::string& words) {
    EXPECT_NE(refusal(inner, o).find(words), std::string::npos) << words << ": " << refusal(inner, o);
  };
  expectRefused(toBox({-5, -5, -5}, {6, 1.5, 6}), "ymax of 1.5 is not outside the domain, which ends at 2");
  expectRefused(toBox({-1, -5, -5}, {6, 6, 6}), "xmin of -1 is not outside");
  expectRefused(toBox({-5, -5, -5}, {6, 6, std::nan("")}), "zmax");
  expectRefused(toSphere(2.5), "does not reach around the domain, whose farthest corner is 2.598");
  expectRefused(toSphere(std::nan("")), "must be lengths");
  FarFieldOptions o;
  o.expansionRatio = 0.9;
  expectRefused(o, "expansion ratio must be between 1 and 10, not 0.9");
  o.expansionRatio = std::nan("");
  expectRefused(o, "expansion ratio");
  o = FarFieldOptions();
  o.maxLayers = 0;
  expectRefused(o, "At least one layer");
  o = FarFieldOptions();
  o.distance = -1;
  expectRefused(o, "must be lengths");
  o = FarFieldOptions();
  o.extend.fill(false);
  expectRefused(o, "No side is to be extended");
  o = toSphere(2.6);
  o.limits.maxAngleInternal = 10;
  expectRefused(o, "The far cells would not be valid");
}

TEST(FarField, RefusesAMeshWithoutSidesAndOneThatTheGeometryLeaves) {
  Monitor monitor;
  PipelineOptions o;
  o.octree.featureSize = 0.25;
  o.stopAfter = Stage::Front;
  const PolyMesh inside = runPipeline(*cube().model(), o, monitor);
  EXPECT_NE(refusal(inside, {}).find("no domain sides"), std::string::npos);

  // The cylinder stands through the floor of its domain.
  o.octree.useDomain = true;
  o.octree.domain = box({-2, -2, 0.5}, {2, 2, 4});
  o.front.region = Region::Outside;
  const PolyMesh standing = runPipeline(*cylinder(24).model(), o, monitor);
  EXPECT_NE(refusal(standing, {}).find("touches the domain side zmin"), std::string::npos);
  FarFieldOptions onGround;
  onGround.extend = kNotGround;
  FarFieldReport report;
  expectGood(standing, extended(standing, onGround, &report), report);
}

TEST(FarField, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(farField(cubeInBox(), {}, stop), AbortError);
}

}  // namespace
