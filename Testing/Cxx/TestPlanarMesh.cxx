// SPDX-License-Identifier: BSD-3-Clause
// The section of a finished mesh, one cell thick.
#include "PlanarMesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "FoamWriter.h"
#include "MeshQuality.h"
#include "Pipeline.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

PolyMesh meshedAround(const Soup& soup, const Box& domain, double size, int layers, Stage last) {
  Monitor monitor;
  PipelineOptions o;
  o.octree.featureSize = size;
  o.octree.baseSize = 4 * size;
  o.octree.useDomain = true;
  o.octree.domain = domain;
  o.front.region = Region::Outside;
  o.refine.layers = layers;
  o.stopAfter = last;
  return runPipeline(*soup.model(), o, monitor);
}

Box box(const Vec3& lo, const Vec3& hi) {
  Box b;
  b.add(lo);
  b.add(hi);
  return b;
}

/// Cubes of several sizes around a unit cube.
PolyMesh levels() { return meshedAround(cube(), box({-1, -1, -1}, {2, 2, 2}), 0.125, 1, Stage::Front); }

/// A cylinder of radius 1 that stands through its domain, with layers.
PolyMesh aroundCylinder() {
  return meshedAround(cylinder(48), box({-3, -3, 0.5}, {3, 3, 1.5}), 0.25, 3, Stage::Refined);
}

PolyMesh planar(const PolyMesh& mesh, int axis, double position, double thickness = 0,
                PlanarMeshReport* report = nullptr) {
  Monitor monitor;
  PlanarMeshOptions o;
  o.axis = axis;
  o.position = position;
  o.thickness = thickness;
  return planarMesh(mesh, o, monitor, report);
}

/// What holds for every planar mesh; returns the area of its front.
double expectPlanar(const PolyMesh& mesh, int axis, double position, double thickness) {
  PlanarMeshReport report;
  const PolyMesh out = planar(mesh, axis, position, thickness, &report);
  EXPECT_EQ(checkTopology(out), "");
  EXPECT_EQ(out.stage, Stage::Refined);
  EXPECT_EQ(out.cellCount, report.cells);
  const Id back = static_cast<Id>(mesh.patchNames.size());
  EXPECT_EQ(out.patchTypes[back], "empty");
  EXPECT_EQ(foamPatchType(out, back + 1), "empty");
  std::vector<double> areas(out.patchNames.size(), 0.0);
  for (Id b = 0; b < out.boundaryFaces(); ++b) {
    const Id f = out.internalFaces() + b;
    const Vec3 normal = measureFace(out.points, out.faces[f]).normal;
    areas[out.patch[b]] += normal.norm();
    const double along = normal[axis] / normal.norm();
    EXPECT_NEAR(along, out.patch[b] == back ? -1 : out.patch[b] == back + 1 ? 1 : 0, 1e-12);
  }
  EXPECT_NEAR(areas[back], areas[back + 1], 1e-12 * areas[back]);
  EXPECT_NEAR(report.area, areas[back], 1e-12 * areas[back]);
  const MeshMeasures m = measure(out);
  const QualitySummary q = summarise(out, m, {});
  EXPECT_GT(q.minTet, 0);
  EXPECT_NEAR(q.totalVolume, report.area * thickness, 1e-11 * q.totalVolume);
  for (const Vec3& p : out.points) EXPECT_NEAR(std::abs(p[axis] - position), 0.5 * thickness, 1e-12);
  PolyMesh again = out;
  canonicalise(again);
  EXPECT_EQ(checksum(again), checksum(out));
  return report.area;
}

TEST(PlanarMesh, SectionsOfCubesAreExactWhereverThePlaneIs) {
  const PolyMesh mesh = levels();
  const auto mostBelow = [&](double z) {  // where the front cuts the body's corner, by the cells themselves
    double area = 0;
    const MeshMeasures m = measure(mesh);
    const Csr<Id> pointsOf = cellPoints(mesh);
    for (Id c = 0; c < mesh.cellCount; ++c) {
      double lo = 1e9, hi = -1e9;
      for (Id p : pointsOf[c]) lo = std::min(lo, mesh.points[p][2]), hi = std::max(hi, mesh.points[p][2]);
      if (lo < z && z < hi) area += m.cells[c].volume / (hi - lo);
    }
    return area;
  };
  for (double z : {0.3, 0.77, 1.61}) {
    EXPECT_NEAR(expectPlanar(mesh, 2, z, 0.1), mostBelow(z), 1e-9) << z;
    EXPECT_NEAR(expectPlanar(mesh, 0, z, 0.1), mostBelow(z), 1e-9) << z;  // the cube is the same all round
  }
  // In a plane of nodes, and by a hair beside it, the section is that of the cells below.
  for (double z : {0.5, 0.5 + 1e-9, 0.5 - 1e-9})
    EXPECT_NEAR(expectPlanar(mesh, 2, z, 1), mostBelow(0.49), 1e-6);
  EXPECT_NEAR(expectPlanar(mesh, 1, -0.99, 0.1), 9, 1e-9);
}

TEST(PlanarMesh, AroundACylinder) {
  const PolyMesh mesh = aroundCylinder();
  const double inside = 24 * std::sin(2 * M_PI / 48);  // of the polygon of 48 sides
  EXPECT_NEAR(expectPlanar(mesh, 2, 1.0, 0.25), 36 - inside, 0.02);
  EXPECT_NEAR(expectPlanar(mesh, 2, 0.93, 0.25), 36 - inside, 0.02);
  const PolyMesh out = planar(mesh, 2, 1.0);
  QualityLimits limits;
  limits.minVolume = limits.minEtaInternal = limits.minEtaBoundary = 0;  // layers are thin on purpose
  EXPECT_EQ(summarise(out, measure(out), limits).violations, 0)
      << describeViolations(out, measure(out), limits);
  EXPECT_EQ(*std::max_element(out.layer.begin(), out.layer.end()), 3);
  double rim = 0;
  std::vector<bool> met(out.patchNames.size(), false);
  for (Id b = 0; b < out.boundaryFaces(); ++b) {
    met[out.patch[b]] = true;
    if (out.patchNames[out.patch[b]] == "wall")
      rim += measureFace(out.points, out.faces[out.internalFaces() + b]).normal.norm();
  }
  EXPECT_NEAR(rim / out.finestSize, 2 * M_PI, 0.03);
  for (std::size_t i = 0; i < met.size(); ++i)  // the sides above and below are not in the section
    EXPECT_EQ(met[i], out.patchNames[i] != "zmin" && out.patchNames[i] != "zmax") << out.patchNames[i];
}

/// No section of a sphere's mesh is square to its wall: the plane meets cells as it likes.
TEST(PlanarMesh, SectionsAtASlant) {
  const Soup sphere =
      cube(12).mapped([](const Vec3& p) { return Vec3((p - Vec3::Constant(0.5)).normalized()); });
  const PolyMesh mesh = meshedAround(sphere, box({-2, -2, -2}, {2, 2, 2}), 0.2, 2, Stage::Refined);
  for (int axis : {0, 1, 2}) {
    for (double at = -1.234; at < 1.3; at += 0.173) {
      const double inside = at * at < 1 ? M_PI * (1 - at * at) : 0;
      EXPECT_NEAR(expectPlanar(mesh, axis, at, 0.1), 16 - inside, 0.25) << "xyz"[axis] << " = " << at;
    }
  }
}

TEST(PlanarMesh, SameBitsForAnyNumberOfThreads) {
  const PolyMesh mesh = levels();
  std::uint64_t sums[2];
  for (int threads : {1, 4})
    withThreads(threads, [&] { sums[threads > 1] = checksum(planar(mesh, 2, 0.3)); });
  EXPECT_EQ(sums[0], sums[1]);
}

TEST(PlanarMesh, Refuses) {
  const PolyMesh mesh = levels();
  const auto refusal = [&](int axis, double position, double thickness) -> std::string {
    try {
      planar(mesh, axis, position, thickness);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(2, 7, 0).find("The plane at 7 does not cut the mesh"), std::string::npos);
  EXPECT_NE(refusal(3, 0, 0).find("The axis must be"), std::string::npos);
  EXPECT_NE(refusal(2, std::nan(""), 0).find("must be lengths"), std::string::npos);
  EXPECT_NE(refusal(2, 0.3, -1).find("must be lengths"), std::string::npos);
}

TEST(PlanarMesh, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(planarMesh(levels(), {}, stop), AbortError);
}

}  // namespace
