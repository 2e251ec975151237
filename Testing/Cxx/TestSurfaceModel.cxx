// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "SurfaceModel.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::cube;
using testing::randomPoint;
using testing::randomSoup;
using testing::Soup;
using Real = long double;
using Real3 = Eigen::Matrix<Real, 3, 1>;

/// Distance from p to the triangle by another road than the kernel's: extended precision, all edges and the
/// plane.
double referenceDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Real3 q = p.cast<Real>();
  const std::array<Real3, 3> v{a.cast<Real>(), b.cast<Real>(), c.cast<Real>()};
  Real best = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Real3 d = v[(k + 1) % 3] - v[k], r = q - v[k];
    const Real t = std::clamp<Real>(r.dot(d) / d.squaredNorm(), 0, 1);
    best = std::min(best, (r - t * d).norm());
  }
  const Real3 n = (v[1] - v[0]).cross(v[2] - v[0]);
  bool inside = true;
  for (int k = 0; k < 3; ++k) inside = inside && (v[(k + 1) % 3] - v[k]).cross(q - v[k]).dot(n) >= 0;
  if (inside && n.norm() > 0) best = std::min(best, std::abs((q - v[0]).dot(n)) / n.norm());
  return static_cast<double>(best);
}

Closest bruteForce(const SurfaceModel& model, const Vec3& p) {
  Closest best;
  for (Id t = 0; t < model.triangleCount(); ++t) {
    const Closest found = model.closestOnTriangle(p, t);
    if (found.distance2 < best.distance2) best = found;
  }
  return best;
}

void expectSame(const Closest& a, const Closest& b) {
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.distance2, b.distance2);
  EXPECT_EQ(a.point, b.point);
}

/// Query points in and around the model: near, far, on corners and on triangles.
std::vector<Vec3> queries(const SurfaceModel& model, int count, unsigned seed) {
  std::mt19937_64 generator(seed);
  const Box& box = model.bounds();
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const Id t = static_cast<Id>(generator() % model.triangleCount());
    const Vec3 spread = randomPoint(generator, -1, 2).cwiseProduct(box.size());
    switch (i % 5) {
      case 0:
        out.push_back(box.lo + spread);
        break;
      case 1:
        out.push_back(model.corner(t, i % 3));
        break;
      case 2:
        out.push_back((model.corner(t, 0) + model.corner(t, 1) + model.corner(t, 2)) / 3);
        break;
      case 3:
        out.push_back(model.corner(t, 0) + 1e-3 * spread);
        break;
      default:
        out.push_back(box.centre() + 1e4 * spread);
    }
  }
  return out;
}

std::string messageOf(const std::function<void()>& body) {
  try {
    body();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(SurfaceModel, MergesEqualPoints) {
  const auto model = cube().model();  // 36 points given
  EXPECT_EQ(model->points().size(), 8u);
  EXPECT_EQ(model->triangleCount(), 12);
  EXPECT_EQ(model->bounds().lo, Vec3(0, 0, 0));
  EXPECT_EQ(model->bounds().hi, Vec3(1, 1, 1));
}

TEST(SurfaceModel, MergesOnlyBitwise) {
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  soup.add({1, 0, 0}, {1, 1, 0}, {0, std::nextafter(1.0, 2.0), 0});
  EXPECT_EQ(soup.model()->points().size(), 5u);
}

TEST(SurfaceModel, NegativeZeroIsZero) {
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  soup.add({-0.0, 0, -0.0}, {0, 1, -0.0}, {-1, 0, 0});
  EXPECT_EQ(soup.model()->points().size(), 4u);
}

TEST(SurfaceModel, DropsTrianglesWithoutAreaAndRepetitions) {
  Soup soup;
  soup.names = {"first", "second"};
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  soup.add({0, 1, 0}, {0, 0, 0}, {1, 0, 0}, 1);           // the same, rotated
  soup.add({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 1);           // the same, turned around
  soup.add({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, 1);           // two equal corners
  soup.add({0, 0, 0}, {0.1, 0.1, 0.1}, {0.3, 0.3, 0.3});  // on a line, to rounding
  soup.add({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1);
  const auto model = soup.model();
  ASSERT_EQ(model->triangleCount(), 2);
  EXPECT_EQ(model->patchOf(0), 0);
  EXPECT_EQ(model->patchOf(1), 1);
  EXPECT_EQ(model->points().size(), 4u);  // points of dropped triangles are gone
}

TEST(SurfaceModel, RefusesWhatItCannotUse) {
  const Soup good = cube();
  Soup bad = good;
  bad.triangles.clear();
  bad.patches.clear();
  EXPECT_NE(messageOf([&] { bad.model(); }).find("no triangles"), std::string::npos);
  for (double value : {std::nan(""), std::numeric_limits<double>::infinity(), -1e200}) {
    bad = good;
    bad.points[17][1] = value;
    EXPECT_NE(messageOf([&] { bad.model(); }).find("Point 17"), std::string::npos);
  }
  for (Id id : {-1, 36}) {
    bad = good;
    bad.triangles[5][2] = id;
    EXPECT_NE(messageOf([&] { bad.model(); }).find("Triangle 5"), std::string::npos);
  }
  for (Id patch : {-1, 1}) {
    bad = good;
    bad.patches[7] = patch;
    EXPECT_NE(messageOf([&] { bad.model(); }).find("Triangle 7"), std::string::npos);
  }
  bad = good;
  bad.patches.pop_back();
  EXPECT_NE(messageOf([&] { bad.model(); }).find("11 patch numbers"), std::string::npos);
  bad = good.mapped([](const Vec3& p) { return Vec3(p[0], p[0], p[0]); });
  EXPECT_NE(messageOf([&] { bad.model(); }).find("area"), std::string::npos);
}

TEST(SurfaceModel, NormalsAreUnitAtAnyScale) {
  for (double scale : {1e-60, 1e-30, 1.0, 1e30, 1e60}) {
    const auto model = cube().mapped([&](const Vec3& p) { return Vec3(scale * p); }).model();
    ASSERT_EQ(model->triangleCount(), 12);
    for (Id t = 0; t < 12; ++t) EXPECT_EQ(model->normal(t).cwiseAbs().maxCoeff(), 1.0);
  }
}

TEST(SurfaceModel, HashFollowsContent) {
  const Soup soup = cube(2, true);
  const std::uint64_t hash = soup.model()->contentHash();
  EXPECT_EQ(soup.model()->contentHash(), hash);
  Soup other = soup;
  other.append(soup);  // repetitions are no content
  EXPECT_EQ(other.model()->contentHash(), hash);
  other = soup;
  other.points[3][0] = std::nextafter(other.points[3][0], 2.0);
  EXPECT_NE(other.model()->contentHash(), hash);
  other = soup;
  other.patches[3] = 5;
  EXPECT_NE(other.model()->contentHash(), hash);
  other = soup;
  other.names[2] = "inlet";
  EXPECT_NE(other.model()->contentHash(), hash);
  other = soup;
  std::swap(other.triangles[0][0], other.triangles[0][1]);
  EXPECT_NE(other.model()->contentHash(), hash);
}

TEST(SurfaceModel, DistanceToOneTriangleIsExact) {
  const auto model = randomSoup(300, 0.3, 1, 3).model();
  for (const Vec3& p : queries(*model, 500, 2))
    for (Id t = 0; t < model->triangleCount(); t += 7) {
      const Closest found = model->closestOnTriangle(p, t);
      const Vec3 &a = model->corner(t, 0), &b = model->corner(t, 1), &c = model->corner(t, 2);
      const double expected = referenceDistance(p, a, b, c);
      ASSERT_NEAR(std::sqrt(found.distance2), expected, 1e-14 + 1e-12 * expected);
      ASSERT_LT(referenceDistance(found.point, a, b, c), 1e-14);
      ASSERT_NEAR((found.point - p).norm(), expected, 1e-14 + 1e-12 * expected);
    }
}

struct Placement {
  double scale;
  Vec3 offset;
};

class SurfaceModelAt : public ::testing::TestWithParam<Placement> {};

TEST_P(SurfaceModelAt, ClosestEqualsBruteForce) {
  const auto [scale, offset] = GetParam();
  for (int count : {1, 2, 4, 5, 9, 33, 700}) {
    const auto place = [&, scale = scale, offset = offset](const Vec3& p) {
      return Vec3(scale * p + offset);
    };
    const auto model = randomSoup(count, 0.2, count, 4).mapped(place).model();
    Closest last;
    for (const Vec3& p : queries(*model, 200, count)) {
      const Closest expected = bruteForce(*model, p);
      ASSERT_TRUE(std::isfinite(expected.distance2));
      ASSERT_TRUE(expected.point.allFinite());
      expectSame(model->closest(p), expected);
      expectSame(model->closest(p, last), expected);  // a bad seed
      last = model->closest(p, expected);             // the best seed
      expectSame(last, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Placements, SurfaceModelAt,
                         ::testing::Values(Placement{1, {0, 0, 0}}, Placement{1e-30, {0, 0, 0}},
                                           Placement{1e30, {0, 0, 0}}, Placement{1, {5e5, 4.8e6, 100}},
                                           Placement{1e-3, {5e5, 4.8e6, 100}}, Placement{1e5, {-1e5, 0, 3}}));

TEST(SurfaceModel, CrossesEqualsBruteForce) {
  std::mt19937_64 g(5);
  const auto model = randomSoup(40, 0.5, 5).model();
  // The ends on different sides of the plane, and the segment's line on the inner side of all three edges.
  const auto crossesOne = [&](const Vec3& p, const Vec3& q, Id t) {
    const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
      return (b - a).cross(c - a).dot(d - a) > 0;
    };
    const Vec3 &a = model->corner(t, 0), &b = model->corner(t, 1), &c = model->corner(t, 2);
    const bool x = side(p, q, a, b);
    return side(a, b, c, p) != side(a, b, c, q) && x == side(p, q, b, c) && x == side(p, q, c, a);
  };
  int crossing = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p = randomPoint(g, -1, 1), q = p + randomPoint(g, -0.5, 0.5);
    bool any = false;
    for (Id t = 0; t < model->triangleCount(); ++t) any = any || crossesOne(p, q, t);
    ASSERT_EQ(model->crosses(p, q), any) << k;
    crossing += any;
  }
  EXPECT_GT(crossing, 100);
  EXPECT_LT(crossing, 1900);
}

TEST(SurfaceModel, TiesGoToTheSmallestTriangle) {
  const auto model = cube(3).mapped([](const Vec3& p) { return Vec3(p + Vec3(0.1, 0.2, 0.3)); }).model();
  int ties = 0;
  for (std::size_t i = 0; i < model->points().size(); ++i) {
    // Outward of a corner point all triangles around it are equally near.
    const Vec3& corner = model->points()[i];
    const Vec3 p = corner + 0.3 * (corner - model->bounds().centre());
    Id first = kNone;
    int around = 0;
    const Closest found = model->closest(p);
    for (Id t = model->triangleCount() - 1; t >= 0; --t)
      if (model->closestOnTriangle(p, t).distance2 == found.distance2) first = t, ++around;
    EXPECT_EQ(found.triangle, first);
    if (around > 1) ++ties;
  }
  EXPECT_GE(ties, 8);
  EXPECT_EQ(cube().model()->closest({0.5, 0.5, 0.5}).triangle, 0);
}

TEST(SurfaceModel, NeighboursAgreeOnTheirSharedEdge) {
  std::mt19937_64 generator(5);
  for (int i = 0; i < 2000; ++i) {
    // A ridge seen from above: both sides see the same point of the ridge.
    const Vec3 a = randomPoint(generator), b = a + Vec3(1 + 0.1 * i, 0.3, 0.1);
    Soup soup;
    soup.add(a, b, a + Vec3(0.2, 1, -3));
    soup.add(b, a, a + Vec3(0.3, -1, -3));
    const auto model = soup.model();
    const Vec3 p = a + (0.2 + 1e-4 * i) * (b - a) + Vec3(0, 0, 0.1);
    const Closest one = model->closestOnTriangle(p, 0), other = model->closestOnTriangle(p, 1);
    ASSERT_EQ(one.point, other.point);
    ASSERT_EQ(one.distance2, other.distance2);
    ASSERT_EQ(model->closest(p).triangle, 0);
  }
}

TEST(SurfaceModel, NothingIsLostFarFromTheOrigin) {
  const Vec3 far(5.5e5, 4.75e6, 1024);
  const auto model = cube().mapped([&](const Vec3& p) { return Vec3(p + far); }).model();
  const Closest found = model->closest(far + Vec3(0.25, 0.5, 1.125));
  EXPECT_EQ(found.distance2, 0.125 * 0.125);
  EXPECT_EQ(found.point, far + Vec3(0.25, 0.5, 1));
}

TEST(SurfaceModel, AnswersNothingForPointsThatAreNone) {
  const auto model = cube().model();
  EXPECT_EQ(model->closest({std::nan(""), 0, 0}).triangle, kNone);
  EXPECT_EQ(model->closest({1e300, 0, 0}).triangle, kNone);
}

TEST(SurfaceModel, DeepTreesStayBounded) {
  // Sizes that shrink geometrically make every weighed split lopsided.
  Soup soup;
  for (int i = 0; i < 3000; ++i) {
    const double s = std::pow(0.95, i);
    soup.add({s, 0, 0}, {s, s, 0}, {s, 0, 0.1 * s});
  }
  const auto model = soup.model();
  for (int i = 0; i < 3000; i += 50) {
    const Vec3 p(std::pow(0.95, i) * 0.99, 0, 0);
    expectSame(model->closest(p), bruteForce(*model, p));
  }
}

TEST(SurfaceModel, TrianglesNearEqualsBruteForce) {
  const auto model = randomSoup(2000, 0.1, 7, 5).model();
  std::mt19937_64 generator(8);
  for (int i = 0; i < 200; ++i) {
    Box box;
    box.add(randomPoint(generator, -0.2, 1.2));
    box.add(box.lo + randomPoint(generator, 0, i % 2 ? 0.05 : 0.5));
    std::vector<Id> expected;
    for (Id t = 0; t < model->triangleCount(); ++t) {
      Box own;
      for (int k = 0; k < 3; ++k) own.add(model->corner(t, k));
      if (own.overlaps(box)) expected.push_back(t);
    }
    EXPECT_EQ(model->trianglesNear(box), expected);
  }
  EXPECT_EQ(model->trianglesNear(model->bounds()).size(), 2000u);
  EXPECT_TRUE(model->trianglesNear(Box()).empty());
}

TEST(SurfaceModel, SameBitsForAnyNumberOfThreads) {
  const Soup soup = randomSoup(40000, 0.02, 9, 10);
  std::unique_ptr<SurfaceModel> reference;
  testing::withThreads(1, [&] { reference = soup.model(); });
  for (int threads : {2, 4})
    testing::withThreads(threads, [&] {
      const auto model = soup.model();
      EXPECT_EQ(model->contentHash(), reference->contentHash());
      for (const Vec3& p : queries(*model, 500, 10)) expectSame(model->closest(p), reference->closest(p));
    });
}

// What is asked within a reach, or only for something near enough, is told as by the plain search.
TEST(SurfaceModel, ClosestWithinAReachAndNearEnough) {
  const Soup soup = randomSoup(500, 0.1, 17, 9);
  const auto model = soup.model();
  for (const Vec3& p : queries(*model, 200, 18)) {
    const Closest exact = model->closest(p);
    const double distance = std::sqrt(exact.distance2);
    expectSame(model->closestWithin(p, 1.01 * distance + 1e-9), exact);
    if (distance > 1e-3) EXPECT_EQ(model->closestWithin(p, 0.9 * distance).triangle, kNone);
    expectSame(model->closest(p, {}, 0.99 * distance), exact);
    const Closest any = model->closest(p, {}, 1.5 * distance + 1e-9);
    EXPECT_LT(std::sqrt(any.distance2), 1.5 * distance + 1e-9);
    EXPECT_EQ(any.distance2, model->closestOnTriangle(p, any.triangle).distance2);
  }
}

}  // namespace
}  // namespace pm
