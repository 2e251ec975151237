// SPDX-License-Identifier: BSD-3-Clause
// Exact predicates, pairs of triangles and the search for them, against rational arithmetic.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <map>

#include "ExactPredicates.h"
#include "KnownIntersections.h"
#include "SelfIntersections.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::randomPoint;
using testing::Soup;
using Triangle = SurfaceModel::Triangle;
using Number = boost::multiprecision::cpp_rational;
using Vector = std::array<Number, 3>;

Vector rational(const Vec3& p) { return {Number(p[0]), Number(p[1]), Number(p[2])}; }
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Number dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Number volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vector o = rational(a);
  return dot(cross(minus(rational(b), o), minus(rational(c), o)), minus(rational(d), o));
}

using Polygon = std::vector<Vector>;

/// Part of a polygon where (p - origin) . normal >= 0.
Polygon clipped(const Polygon& polygon, const Vector& origin, const Vector& normal) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Number a = dot(minus(p, origin), normal), b = dot(minus(q, origin), normal);
    if (a >= 0) out.push_back(p);
    if (a * b >= 0) continue;
    const Number t = a / (a - b);
    const Vector d = minus(q, p);
    out.push_back({p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]});
  }
  return out;
}

Polygon cornersOf(const std::vector<Vec3>& points, const Triangle& t) {
  return {rational(points[t[0]]), rational(points[t[1]]), rational(points[t[2]])};
}

Vector normalOf(const Polygon& t) { return cross(minus(t[1], t[0]), minus(t[2], t[0])); }

/// The common part of two triangles by clipping, and from its extent the kind of contact.
Contact referenceContact(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b) {
  const Polygon s = cornersOf(points, a), t = cornersOf(points, b);
  const Vector ns = normalOf(s), nt = normalOf(t);
  Polygon common = clipped(clipped(s, t[0], nt), t[0], {-nt[0], -nt[1], -nt[2]});
  for (int k = 0; k < 3; ++k) common = clipped(common, t[k], cross(nt, minus(t[(k + 1) % 3], t[k])));
  std::sort(common.begin(), common.end());
  common.erase(std::unique(common.begin(), common.end()), common.end());
  int shared = 0;
  for (Id p : a) shared += std::count(b.begin(), b.end(), p);
  if (common.empty()) return Contact::None;
  const Vector along = minus(common.back(), common.front());
  const Vector n = cross(ns, nt);
  if (n == Vector{0, 0, 0}) {
    for (const Vector& p : common)
      if (cross(along, minus(p, common.front())) != Vector{0, 0, 0}) return Contact::Overlap;
    return Contact::None;
  }
  if (common.size() == 1) return shared == 0 ? Contact::Point : Contact::None;
  if (shared == 2) return Contact::None;
  int onPlane[2] = {0, 0};
  for (int k = 0; k < 3; ++k) {
    onPlane[0] += dot(minus(s[k], t[0]), nt) == 0;
    onPlane[1] += dot(minus(t[k], s[0]), ns) == 0;
  }
  return onPlane[0] == 2 || onPlane[1] == 2 ? Contact::Edge : Contact::Crossing;
}

std::map<std::pair<Id, Id>, Contact> reference(const SurfaceModel& model) {
  std::map<std::pair<Id, Id>, Contact> out;
  for (Id b = 0; b < model.triangleCount(); ++b)
    for (Id a = 0; a < b; ++a) {
      Box x, y;
      for (int k = 0; k < 3; ++k) {
        x.add(model.corner(a, k));
        y.add(model.corner(b, k));
      }
      if (!x.overlaps(y)) continue;
      const Contact c = referenceContact(model.points(), model.triangles()[a], model.triangles()[b]);
      if (c != Contact::None) out[{a, b}] = c;
    }
  return out;
}

std::array<int, 5> countKinds(const SelfIntersections& found) {
  std::array<int, 5> counts{};
  for (const TrianglePair& p : found.pairs) ++counts[static_cast<int>(p.contact)];
  return counts;
}

SelfIntersections search(const Soup& soup) {
  Monitor monitor;
  return selfIntersections(*soup.model(), monitor);
}

void expectEqualsReference(const SurfaceModel& model) {
  Monitor monitor;
  const SelfIntersections found = selfIntersections(model, monitor);
  std::map<std::pair<Id, Id>, Contact> pairs;
  for (const TrianglePair& p : found.pairs) pairs[{p.a, p.b}] = p.contact;
  EXPECT_EQ(pairs.size(), found.pairs.size());
  EXPECT_EQ(pairs, reference(model));
  // Every end lies in the planes of both triangles, as far as its coordinates can say.
  for (const IntersectionSegment& s : found.segments)
    for (Id row : {s.start, s.end})
      for (Id t : {s.a, s.b})
        EXPECT_LE(std::sqrt(model.closestOnTriangle(found.points[row], t).distance2),
                  1e-15 * (model.bounds().diagonal() + model.bounds().hi.cwiseAbs().maxCoeff()));
}

/// Triangles with corners on a coarse lattice: most contacts are degenerate.
Soup latticeSoup(int count, int steps, unsigned seed, const std::function<Vec3(const Vec3&)>& map) {
  std::mt19937_64 generator(seed);
  const auto corner = [&] {
    const Vec3 p = randomPoint(generator, 0, steps + 1);
    return map(Vec3(std::floor(p[0]), std::floor(p[1]), std::floor(p[2])));
  };
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = corner(), b = corner(), c = corner();
    soup.add(a, b, c);
  }
  return soup;
}

TEST(ExactPredicates, SignsEqualRationalArithmetic) {
  std::mt19937_64 generator(5);
  for (const auto& [scale, offset] : {std::pair{1.0, Vec3(0, 0, 0)},
                                      {1e-30, Vec3(0, 0, 0)},
                                      {1e30, Vec3(0, 0, 0)},
                                      {0.1, Vec3(5.5e5, 4.75e6, 100)}}) {
    int zeros = 0;
    for (int i = 0; i < 1000; ++i) {
      std::array<Vec3, 4> p;
      for (Vec3& v : p) v = scale * randomPoint(generator) + offset;
      // The fourth point as near to the plane of the others as rounding leaves it, or exactly on it.
      const double u = randomPoint(generator)[0], v = i % 3 == 0 ? 0 : randomPoint(generator)[0];
      p[3] = i % 5 == 0 ? p[i % 3] : Vec3(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]));
      const Number exact = volume(p[0], p[1], p[2], p[3]);
      EXPECT_EQ(orient3d(p[0], p[1], p[2], p[3]), exact.sign());
      EXPECT_EQ(orient3d(p[1], p[0], p[2], p[3]), -exact.sign());
      const double value = exact.convert_to<double>();
      EXPECT_NEAR(volume3d(p[0], p[1], p[2], p[3]), value, 1e-15 * std::abs(value));
      zeros += exact.sign() == 0;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector n = cross(minus(rational(p[1]), rational(p[0])), minus(rational(p[3]), rational(p[0])));
        EXPECT_EQ(orient2d(p[0], p[1], p[3], axis), n[axis].sign());
        const double area = n[axis].convert_to<double>();
        EXPECT_NEAR(area2d(p[0], p[1], p[3], axis), area, 1e-15 * std::abs(area));
      }
    }
    EXPECT_GE(zeros, 200);
  }
}

TEST(TriangleTriangle, TellsTheKindsApart) {
  const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0},  {0, 4, 0},  {1, 1, -1}, {1, 1, 1}, {9, 9, 0},
                            {1, 1, 0}, {1, 1, 2},  {2, 1, 2},  {2, 1, 0},  {5, 0, 0}, {1, 5, 0},
                            {2, 2, 1}, {-1, 2, 0}, {2, -1, 0}, {2, 0, 3},  {3, 0, 3}};
  const Triangle base{0, 1, 2};
  const auto kind = [&](Triangle t) {
    const TriangleContact there = contactOf(p, base, t), back = contactOf(p, t, base);
    EXPECT_EQ(there.kind, back.kind);
    EXPECT_EQ(there.count, back.count);
    return there.kind;
  };
  EXPECT_EQ(kind({3, 4, 5}), Contact::Crossing);
  EXPECT_EQ(kind({6, 7, 8}), Contact::Point);
  EXPECT_EQ(kind({6, 9, 7}), Contact::Edge);
  EXPECT_EQ(kind({6, 10, 11}), Contact::Overlap);
  EXPECT_EQ(kind({4, 7, 8}), Contact::None);
  EXPECT_EQ(kind({0, 12, 7}), Contact::None);      // a common corner
  EXPECT_EQ(kind({0, 6, 12}), Contact::Edge);      // a common corner, and an edge that lies inside
  EXPECT_EQ(kind({0, 3, 12}), Contact::Crossing);  // a common corner, and a cut that starts there
  EXPECT_EQ(kind({0, 1, 7}), Contact::None);       // a common edge
  EXPECT_EQ(kind({0, 1, 14}), Contact::None);      // a common edge, unfolded in one plane
  EXPECT_EQ(kind({0, 1, 6}), Contact::Overlap);    // a common edge, folded flat
  EXPECT_EQ(kind({1, 15, 16}), Contact::None);
}

TEST(TriangleTriangle, NeighboursNameTheirCommonEndAlike) {
  // A blade through the diagonal of a square: both halves of the square end at the same point, bit for bit.
  const std::vector<Vec3> p{{0, 0, 0},        {1, 0, 0.1},     {1, 1, 0.3},   {0, 1, 0.17},
                            {0.21, 0.4, 0.9}, {0.83, 0.55, 1}, {0.6, 0.5, -2}};
  const TriangleContact lower = contactOf(p, {0, 1, 2}, {4, 5, 6}),
                        upper = contactOf(p, {6, 4, 5}, {0, 2, 3});
  ASSERT_EQ(lower.kind, Contact::Crossing);
  ASSERT_EQ(upper.kind, Contact::Crossing);
  int common = 0;
  for (const MeetingPoint& a : lower.ends)
    for (const MeetingPoint& b : upper.ends) common += a == b && positionOf(p, a) == positionOf(p, b);
  EXPECT_EQ(common, 1);
}

TEST(SelfIntersections, EqualRationalArithmetic) {
  const auto id = [](const Vec3& p) { return p; };
  expectEqualsReference(*latticeSoup(90, 3, 1, id).model());
  expectEqualsReference(*latticeSoup(60, 2, 2, [](const Vec3& p) { return Vec3(1e-30 * p); }).model());
  expectEqualsReference(*latticeSoup(60, 2, 3, [](const Vec3& p) { return Vec3(1e30 * p); }).model());
  // Rounding makes near misses and slivers of what was degenerate.
  expectEqualsReference(
      *latticeSoup(70, 3, 4, [](const Vec3& p) { return Vec3(0.1 * p + Vec3(5.5e5, 4.75e6, 100)); }).model());
  expectEqualsReference(*latticeSoup(70, 3, 5, [](const Vec3& p) {
                           return Vec3(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * p);
                         }).model());
  expectEqualsReference(*testing::randomSoup(120, 0.3, 6, 5).model());
}

TEST(SelfIntersections, CleanSurfacesHaveNone) {
  for (const Soup& soup : {testing::cube(6), testing::cylinder(200), testing::disc(300)}) {
    EXPECT_TRUE(search(soup).pairs.empty());
    const Eigen::AngleAxisd turn(0.3, Vec3(3, 1, 2).normalized());
    EXPECT_TRUE(search(soup.mapped([&](const Vec3& p) { return Vec3(turn * p); })).pairs.empty());
  }
}

TEST(SelfIntersections, CoplanarSheetsOverlapAndMakeNoSegments) {
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0.25}, {0, 1, 0.125}, 2);
  soup.addGrid({0, 0, 0}, {1, 0, 0.25}, {0, 1, 0.125}, 4);
  const SelfIntersections found = search(soup);
  // Each of the 32 small triangles lies in one large one.
  EXPECT_EQ(countKinds(found), (std::array<int, 5>{0, 0, 0, 0, 32}));
  EXPECT_TRUE(found.segments.empty());
}

/// Sphere of radius 1 as a grid over longitude and latitude.
Soup sphere(int n, const Vec3& centre) {
  Soup soup;
  soup.addGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n);
  const double pi = 3.14159265358979323846;
  return soup.mapped([&](const Vec3& p) {
    const double lon = 2 * pi * (p[0] == 1 ? 0 : p[0]), lat = pi * p[1];
    if (p[1] == 0 || p[1] == 1) return Vec3(centre + Vec3(0, 0, p[1] == 0 ? 1 : -1));
    return Vec3(centre + Vec3(std::sin(lat) * std::cos(lon), std::sin(lat) * std::sin(lon), std::cos(lat)));
  });
}

TEST(SelfIntersections, TwoSpheresCutInOneClosedCurve) {
  Soup soup = sphere(60, {0, 0, 0});
  soup.append(sphere(71, {0.9, 0.3, 0.2}));
  const SelfIntersections found = search(soup);
  EXPECT_EQ(countKinds(found)[static_cast<int>(Contact::Crossing)], static_cast<int>(found.pairs.size()));
  std::vector<int> degree(found.points.size(), 0);
  double length = 0;
  for (const IntersectionSegment& s : found.segments) {
    ++degree[s.start];
    ++degree[s.end];
    length += (found.points[s.end] - found.points[s.start]).norm();
  }
  EXPECT_EQ(found.points.size(), found.segments.size());
  for (int d : degree) EXPECT_EQ(d, 2);
  const double radius = std::sqrt(1 - Vec3(0.9, 0.3, 0.2).squaredNorm() / 4);
  EXPECT_NEAR(length, 2 * 3.14159265358979 * radius, 0.01);
}

TEST(SelfIntersections, SameBitsForAnyNumberOfThreads) {
  Soup soup = testing::randomSoup(3000, 0.15, 9, 7);
  soup.append(latticeSoup(100, 4, 2, [](const Vec3& p) { return Vec3(0.25 * p); }));
  const auto model = soup.model();
  Monitor monitor;
  SelfIntersections one, many;
  testing::withThreads(1, [&] { one = selfIntersections(*model, monitor); });
  testing::withThreads(4, [&] { many = selfIntersections(*model, monitor); });
  EXPECT_EQ(one.points, many.points);
  EXPECT_EQ(one.names, many.names);
  ASSERT_EQ(one.pairs.size(), many.pairs.size());
  ASSERT_EQ(one.segments.size(), many.segments.size());
  for (std::size_t i = 0; i < one.segments.size(); ++i) {
    EXPECT_EQ(one.segments[i].a, many.segments[i].a);
    EXPECT_EQ(one.segments[i].b, many.segments[i].b);
    EXPECT_EQ(one.segments[i].start, many.segments[i].start);
    EXPECT_EQ(one.segments[i].end, many.segments[i].end);
  }
}

/// Triangles around one point; apex at height h above their rim.
Soup fan(int count, double h) {
  Soup soup;
  const auto rim = [&](int i) {
    const double angle = 2 * 3.14159265358979323846 * (i % count) / count;
    return Vec3(std::cos(angle), std::sin(angle), 0);
  };
  for (int i = 0; i < count; ++i) soup.add({0, 0, h}, rim(i), rim(i + 1));
  return soup;
}

TEST(SelfIntersections, LargeFansAndConesHaveNone) {
  for (double h : {0.0, 0.5, 20.0}) EXPECT_TRUE(search(fan(50000, h)).pairs.empty());
  // A plate through a cone of slope 1 meets the triangles on its line alone.
  Soup cut = fan(50000, 1);
  cut.add({0.25, -1e-5, 0.1}, {0.25, 1e-5, 0.1}, {0.9, 0, 0.8});
  const SelfIntersections found = search(cut);
  EXPECT_FALSE(found.pairs.empty());
  EXPECT_LT(found.pairs.size(), 10u);
  for (const TrianglePair& pair : found.pairs) EXPECT_EQ(pair.b, 50000);
}

TEST(SelfIntersections, TrianglesAroundAPointEqualAllPairs) {
  // Folded and crossing fans around two points, some in one plane, among others.
  std::mt19937_64 generator(5);
  Soup soup = testing::randomSoup(80, 0.5, 6, 5);
  for (int i = 0; i < 300; ++i) {
    Vec3 p = randomPoint(generator, -1, 1), q = p + randomPoint(generator, -0.3, 0.3);
    if (i % 3 == 0) p[2] = q[2] = 0;
    soup.add(Vec3(i % 2, 0, 0), p, q);
  }
  const auto model = soup.model();
  std::vector<std::pair<Id, Id>> expected, found;
  for (Id a = 0; a < model->triangleCount(); ++a)
    for (Id b = a + 1; b < model->triangleCount(); ++b)
      if (contactOf(model->points(), model->triangles()[a], model->triangles()[b]).kind != Contact::None)
        expected.push_back({a, b});
  for (const TrianglePair& pair : search(soup).pairs) found.push_back({pair.a, pair.b});
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_EQ(found, expected);
}

TEST(SelfIntersections, AreFoundOnceForAGeometry) {
  Monitor monitor;
  const auto model = testing::randomSoup(200, 0.3, 6).model(),
             same = testing::randomSoup(200, 0.3, 6).model();
  const auto first = knownIntersections(*model, monitor);
  EXPECT_FALSE(first->segments.empty());
  EXPECT_EQ(knownIntersections(*same, monitor), first);
  EXPECT_TRUE(knownIntersections(*testing::cube(2).model(), monitor)->pairs.empty());
}

TEST(SelfIntersections, StopsOnRequest) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(selfIntersections(*testing::cube(2).model(), stop), AbortError);
}

}  // namespace
}  // namespace pm
