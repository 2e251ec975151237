// SPDX-License-Identifier: BSD-3-Clause
// Features resolved on meshes that went through the chain, inside small closed shapes.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "DummyLayer.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "Project.h"
#include "ResolveFeatures.h"
#include "WallSurface.h"

namespace {

using namespace pm;

struct Soup {
  std::vector<Vec3> points;
  std::vector<SurfaceModel::Triangle> triangles;
  std::vector<Id> patches;
  std::vector<std::string> names;

  void add(const Vec3& a, const Vec3& b, const Vec3& c, Id patch) {
    const Id n = static_cast<Id>(points.size());
    points.insert(points.end(), {a, b, c});
    triangles.push_back({n, n + 1, n + 2});
    patches.push_back(patch);
  }
  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Id patch) {
    add(a, b, c, patch);
    add(a, c, d, patch);
  }
  void turn(const Eigen::Matrix3d& r) {
    for (Vec3& p : points) p = r * p;
  }
  std::unique_ptr<SurfaceModel> model() const {
    return std::make_unique<SurfaceModel>(points, triangles, patches, names);
  }
};

const Eigen::Matrix3d kTurn = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();

/// Edge 2, a patch for each axis.
Soup cube() {
  Soup s;
  s.names = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis)
    for (double side : {-1.0, 1.0}) {
      Vec3 n = Vec3::Zero(), u = n, v = n;
      n[axis] = side;
      u[(axis + 1) % 3] = side;
      v[(axis + 2) % 3] = 1;
      s.quad(n - u - v, n + u - v, n + u + v, n - u + v, axis);
    }
  return s;
}

/// Radius 1, height 2: two curves without corners.
Soup cylinder(int columns) {
  Soup s;
  s.names = {"side", "bottom", "top"};
  const auto at = [&](int i, double z) {
    const double t = 2 * M_PI * (i % columns) / columns;
    return Vec3(std::cos(t), std::sin(t), z);
  };
  for (int i = 0; i < columns; ++i) {
    s.quad(at(i, -1), at(i + 1, -1), at(i + 1, 1), at(i, 1), 0);
    s.add(Vec3(0, 0, -1), at(i + 1, -1), at(i, -1), 1);
    s.add(Vec3(0, 0, 1), at(i, 1), at(i + 1, 1), 2);
  }
  return s;
}

/// A sphere of triangles too small and too many to have a sharp edge.
Soup sphere() {
  Soup s;
  s.names = {"sphere"};
  const int n = 24;
  const auto at = [&](int i, int j) {
    const double a = M_PI * i / n, b = M_PI * (j % (2 * n)) / n;
    return Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b),
                i == 0   ? 1.0
                : i == n ? -1.0
                         : std::cos(a));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) s.add(at(i, j), at(i + 1, j), at(i, j + 1), 0);
      if (i < n - 1) s.add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), 0);
    }
  return s;
}

PolyMesh projected(const SurfaceModel& model, DistanceField& field, double size) {
  Monitor monitor;
  OctreeDecomposeOptions octree;
  octree.featureSize = size;
  octree.featureDepth = FeatureDepth::Full;
  PolyMesh mesh = dummyLayer(paintFront(decompose(model, octree, monitor), model, {}, monitor), {}, monitor);
  project(mesh, field, {}, monitor);
  return mesh;
}

struct Resolved {
  std::unique_ptr<SurfaceModel> model;
  PolyMesh mesh;
  ResolveFeaturesReport report;
};

Resolved resolve(const Soup& soup, double size) {
  Resolved r;
  r.model = soup.model();
  DistanceField field(*r.model, size);
  r.mesh = projected(*r.model, field, size);
  Monitor monitor;
  resolveFeatures(r.mesh, field, {}, monitor, &r.report);
  return r;
}

void expectValid(const PolyMesh& mesh) {
  EXPECT_EQ(mesh.stage, Stage::Resolved);
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(describeViolations(mesh, measure(mesh), {}), "");
  PolyMesh again = mesh;
  canonicalise(again);
  EXPECT_EQ(checksum(again), checksum(mesh));
}

TEST(ResolveFeatures, CubeInAnyPosition) {
  Soup soup = cube();
  soup.turn(kTurn);
  const Resolved r = resolve(soup, 0.15);
  expectValid(r.mesh);
  EXPECT_NEAR(r.report.featureLength, 24, 1e-9);
  EXPECT_GT(r.report.resolvedLength, 0.95 * 24);
  EXPECT_EQ(r.report.corners, 8);
  EXPECT_EQ(r.report.resolvedCorners, 8);
  // Each wall face lies in one side of the cube, in that side's patch.
  const Id first = r.mesh.internalFaces();
  double area = 0, wrong = 0;
  for (Id i = 0; i < r.mesh.boundaryFaces(); ++i) {
    const FaceMeasures m = measureFace(r.mesh.points, r.mesh.faces[first + i], true);
    const Vec3 normal = kTurn.transpose() * m.normal;
    area += normal.norm();
    if (std::abs(normal[r.mesh.patch[i]]) < 0.99 * normal.norm()) wrong += normal.norm();
  }
  EXPECT_LT(wrong, 0.03 * area);
  EXPECT_NEAR(area, 24, 0.3);
}

TEST(ResolveFeatures, ClosedCurves) {
  Soup soup = cylinder(48);
  soup.turn(kTurn);
  const Resolved r = resolve(soup, 0.15);
  expectValid(r.mesh);
  EXPECT_GT(r.report.resolvedLength, 0.95 * r.report.featureLength);
  EXPECT_NEAR(r.report.featureLength, 4 * M_PI, 0.02);
}

TEST(ResolveFeatures, InterfaceInAPlane) {
  Soup soup = cube();
  soup.names.push_back("spot");
  // The upper side again, in two patches that meet in a slanted line.
  soup.triangles.erase(soup.triangles.end() - 2, soup.triangles.end());
  soup.patches.erase(soup.patches.end() - 2, soup.patches.end());
  const Vec3 a(-0.23, -1, 1), b(0.41, 1, 1);
  soup.quad(Vec3(-1, -1, 1), a, b, Vec3(-1, 1, 1), 2);
  soup.quad(a, Vec3(1, -1, 1), Vec3(1, 1, 1), b, 3);
  const double size = 0.15;
  const Resolved r = resolve(soup, size);
  expectValid(r.mesh);
  EXPECT_GT(r.report.resolvedLength, 0.97 * r.report.featureLength);
  // The patches meet where the interface is.
  std::vector<std::uint8_t> touches(r.mesh.points.size(), 0);
  for (Id i = 0; i < r.mesh.boundaryFaces(); ++i)
    for (Id p : r.mesh.faces[r.mesh.internalFaces() + i]) touches[p] |= 1 << r.mesh.patch[i];
  int between = 0;
  for (std::size_t p = 0; p < touches.size(); ++p) {
    if ((touches[p] & 12) != 12 || std::abs(r.mesh.points[p].y()) > 0.95) continue;
    ++between;
    EXPECT_LT((r.mesh.points[p] - a).cross((b - a).normalized()).norm(), 0.1 * size);
  }
  EXPECT_GT(between, 8);
}

TEST(ResolveFeatures, LeavesSmoothShapesAlone) {
  const auto model = sphere().model();
  DistanceField field(*model, 0.2);
  PolyMesh mesh = projected(*model, field, 0.2);
  const std::vector<Vec3> before = mesh.points;
  Monitor monitor;
  ResolveFeaturesReport report;
  resolveFeatures(mesh, field, {}, monitor, &report);
  expectValid(mesh);
  EXPECT_EQ(report.featureLength, 0);
  // Nothing but the fitting of the faces: small shifts of wall nodes.
  for (std::size_t p = 0; p < before.size(); ++p) {
    const double limit = mesh.base[p] == kNone ? 0.0 : 0.05 * mesh.finestSize;
    EXPECT_LE((mesh.points[p] - before[p]).norm(), limit);
  }
}

TEST(ResolveFeatures, SameForAnyNumberOfThreads) {
  Soup soup = cube();
  soup.turn(kTurn);
  std::uint64_t first = 0;
  for (int threads : {1, 2, 4}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const std::uint64_t sum = checksum(resolve(soup, 0.25).mesh);
    if (threads == 1) first = sum;
    EXPECT_EQ(sum, first);
  }
}

// ------------------------------------------------------------------------------------ shapes in any position

/// A uniformly random rotation.
Eigen::Matrix3d rotation(unsigned seed) {
  std::mt19937_64 g(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q;
  for (double* x : {&q.w(), &q.x(), &q.y(), &q.z()}) *x = normal(g);
  return q.normalized().toRotationMatrix();
}

/// A closed prism over a polygon in the plane, from z = 0 to 1: a patch for its sides, one for each end. The
/// ends are fans about the first point.
Soup prismOver(const std::vector<std::array<double, 2>>& polygon) {
  Soup s;
  s.names = {"sides", "bottom", "top"};
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i, double z) { return Vec3(polygon[i % n][0], polygon[i % n][1], z); };
  for (std::size_t i = 0; i < n; ++i) s.quad(at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1), 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    s.add(at(0, 0), at(i + 1, 0), at(i, 0), 1);
    s.add(at(0, 1), at(i, 1), at(i + 1, 1), 2);
  }
  return s;
}

/// Two thirds of a cube missing: a concave edge, and corners where it ends.
Soup block() { return prismOver({{0.5, 0.4}, {0.5, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 0.4}}); }

/// Radius 1, height 2: a circle without corners. The apex is the end of no sharp edge.
Soup cone(int columns) {
  Soup s;
  s.names = {"side", "bottom"};
  const auto at = [&](int i) {
    const double t = 2 * M_PI * (i % columns) / columns;
    return Vec3(std::cos(t), std::sin(t), 0);
  };
  for (int i = 0; i < columns; ++i) {
    s.add(Vec3(0, 0, 2), at(i), at(i + 1), 0);
    s.add(Vec3(0, 0, 0), at(i + 1), at(i), 1);
  }
  return s;
}

/// The part of a closed convex soup where x[axis] is below a value, closed by a patch of its own. Triangles
/// that share an edge are cut at the same point of it, to the bit.
Soup below(const Soup& soup, int axis, double value, const std::string& name) {
  Soup out;
  out.names = soup.names;
  out.names.push_back(name);
  std::vector<std::array<Vec3, 2>> rim;
  const auto isIn = [&](const Vec3& p) { return p[axis] < value; };
  const auto cut = [&](Vec3 a, Vec3 b) {
    if (isIn(b)) std::swap(a, b);
    Vec3 p = a + (value - a[axis]) / (b[axis] - a[axis]) * (b - a);
    p[axis] = value;
    return p;
  };
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    std::vector<Vec3> ring;
    std::array<Vec3, 2> segment;
    bool crosses = false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &p = soup.points[soup.triangles[t][k]], &q = soup.points[soup.triangles[t][(k + 1) % 3]];
      if (isIn(p)) ring.push_back(p);
      if (isIn(p) == isIn(q)) continue;
      ring.push_back(cut(p, q));
      segment[isIn(p) ? 1 : 0] = ring.back();
      crosses = true;
    }
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) out.add(ring[0], ring[k], ring[k + 1], soup.patches[t]);
    if (crosses) rim.push_back(segment);
  }
  Vec3 middle = Vec3::Zero();
  for (const auto& segment : rim) middle += segment[0] / static_cast<double>(rim.size());
  middle[axis] = value;
  for (const auto& [from, to] : rim) out.add(middle, from, to, static_cast<Id>(out.names.size()) - 1);
  return out;
}

/// A corner inside the sphere, three on it, and arcs between these.
Soup cutSphere() { return below(below(below(sphere(), 0, 0.3, "x"), 1, 0.2, "y"), 2, 0.1, "z"); }

std::vector<double> patchAreas(const Soup& shape) {
  std::vector<double> areas(shape.names.size(), 0.0);
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const auto& [a, b, c] = shape.triangles[t];
    const Vec3 u = shape.points[b] - shape.points[a], v = shape.points[c] - shape.points[a];
    areas[shape.patches[t]] += 0.5 * u.cross(v).norm();
  }
  return areas;
}

std::vector<double> patchAreas(const PolyMesh& mesh) {
  std::vector<double> areas(mesh.patchNames.size(), 0.0);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i)
    areas[mesh.patch[i]] +=
        measureFace(mesh.points, mesh.faces[mesh.internalFaces() + i], true).normal.norm();
  return areas;
}

/// Three rotations: on the average at least that share of the features' length, and `least` of it each time;
/// one corner may be missed in all of them. The whole of each patch is where it was.
void expectResolved(const Soup& shape, double size, Id corners, double share = 0.99, double least = 0.97) {
  constexpr int kRotations = 3;
  const std::vector<double> before = patchAreas(shape);
  double shares = 0;
  Id missed = 0;
  for (unsigned seed = 1; seed <= kRotations; ++seed) {
    SCOPED_TRACE("rotation " + std::to_string(seed));
    Soup soup = shape;
    soup.turn(rotation(seed));
    const Resolved r = resolve(soup, size);
    expectValid(r.mesh);
    EXPECT_EQ(r.report.corners, corners);
    missed += corners - r.report.resolvedCorners;
    const double now = r.report.resolvedLength / r.report.featureLength;
    EXPECT_GE(now, least);
    shares += now;
    const std::vector<double> after = patchAreas(r.mesh);
    for (std::size_t p = 0; p < after.size(); ++p)
      EXPECT_NEAR(after[p] / before[p], 1, 0.01) << soup.names[p];
  }
  EXPECT_GE(shares / kRotations, share);
  EXPECT_LE(missed, 1);
}

/// A cube of edge 2 whose sides are three by three squares of two patches in turn.
Soup checkerboard() {
  Soup s;
  s.names = {"black", "white"};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const auto at = [&](int a, int b) {
            Vec3 p = Vec3::Zero();
            p[axis] = 2 * side - 1;
            p[(axis + 1) % 3] = 2. / 3 * a - 1;
            p[(axis + 2) % 3] = 2. / 3 * b - 1;
            return p;
          };
          s.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), (i + j + axis + side) % 2);
        }
  return s;
}

TEST(ResolveFeatures, CheckerboardOfPatches) {
  const std::vector<double> before = patchAreas(checkerboard());
  for (unsigned seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    Soup soup = checkerboard();
    soup.turn(rotation(seed));
    const Resolved r = resolve(soup, 0.17);
    expectValid(r.mesh);
    EXPECT_GT(r.report.resolvedLength, 0.98 * r.report.featureLength);
    const std::vector<double> after = patchAreas(r.mesh);
    for (std::size_t p = 0; p < after.size(); ++p) EXPECT_NEAR(after[p] / before[p], 1, 0.01);
  }
}

TEST(ResolveFeatures, EdgesBehindAWallDoNotDentIt) {
  constexpr double cell = 0.1, edge = 2;
  Soup room = cube();
  const Id patch = static_cast<Id>(room.names.size());
  room.names.push_back("rib");
  for (double z : {-0.63, -0.2, 0.27}) {  // ribs on the wall's outer side, open towards it, 0.4 cells high
    const double low = edge / 2 + 0.002, high = edge / 2 + 0.4 * cell;
    const Vec3 a(low, -0.7, z), b(high, -0.7, z), c(high, 0.7, z), d(low, 0.7, z), up(0, 0, 0.2);
    room.quad(a, b, c, d, patch);
    room.quad(b, b + up, c + up, c, patch);
    room.quad(a + up, b + up, c + up, d + up, patch);
  }
  const Resolved r = resolve(room, cell);
  expectValid(r.mesh);
  for (const Vec3& p : r.mesh.points) EXPECT_LT(p.cwiseAbs().maxCoeff(), edge / 2 + 0.1 * cell);
}

TEST(ResolveFeatures, RotatedCube) { expectResolved(cube(), 2. / 25, 8); }
TEST(ResolveFeatures, RotatedBlock) { expectResolved(block(), 1. / 25, 12); }
TEST(ResolveFeatures, RotatedCylinder) { expectResolved(cylinder(64), 2. / 25, 0); }
TEST(ResolveFeatures, RotatedCone) { expectResolved(cone(64), 2. / 25, 0, 0.98); }
TEST(ResolveFeatures, RotatedCutSphere) { expectResolved(cutSphere(), 2. / 25, 4); }

TEST(ResolveFeatures, RotatedShapesGiveTheSameBitsForAnyNumberOfThreads) {
  for (const Soup& shape : {block(), cone(48), cutSphere()}) {
    Soup soup = shape;
    soup.turn(rotation(7));
    std::set<std::uint64_t> sums;
    for (int threads : {1, 2, 4}) {
      tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      sums.insert(checksum(resolve(soup, 0.1).mesh));
    }
    EXPECT_EQ(sums.size(), 1u);
  }
}

TEST(ResolveFeatures, StopsOnRequest) {
  struct Impatient : Monitor {
    mutable int calls = 0;
    bool aborted() const override { return ++calls > 3; }
  } impatient;
  const auto model = cube().model();
  DistanceField field(*model, 0.25);
  PolyMesh mesh = projected(*model, field, 0.25);
  EXPECT_THROW(resolveFeatures(mesh, field, {}, impatient), AbortError);
}

TEST(ResolveFeatures, RefusesWhatDoesNotFit) {
  const auto model = cube().model();
  DistanceField field(*model, 0.25);
  PolyMesh mesh = projected(*model, field, 0.25);
  Monitor monitor;
  PolyMesh tooEarly = mesh;
  tooEarly.stage = Stage::Layer;
  EXPECT_THROW(resolveFeatures(tooEarly, field, {}, monitor), InputError);
  mesh.patchNames[1] = "another";
  EXPECT_THROW(resolveFeatures(mesh, field, {}, monitor), InputError);
}

}  // namespace
