// SPDX-License-Identifier: BSD-3-Clause
#include "TestSurfaces.h"

#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>

namespace pm::testing {

namespace {

Vec3 onCircle(int i, int facets, double z) {
  const double angle = 2 * 3.14159265358979323846 * (i % facets) / facets;
  return {std::cos(angle), std::sin(angle), z};
}

}  // namespace

void Soup::add(const Vec3& a, const Vec3& b, const Vec3& c, Id patch) {
  const Id first = static_cast<Id>(points.size());
  points.insert(points.end(), {a, b, c});
  triangles.push_back({first, first + 1, first + 2});
  patches.push_back(patch);
}

void Soup::addGrid(const Vec3& origin, const Vec3& u, const Vec3& v, int n, Id patch) {
  const auto at = [&](int i, int j) { return Vec3(origin + u * (double(i) / n) + v * (double(j) / n)); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1), patch);
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1), patch);
    }
}

void Soup::append(const Soup& other) {
  const Id first = static_cast<Id>(points.size());
  points.insert(points.end(), other.points.begin(), other.points.end());
  for (const auto& t : other.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  patches.insert(patches.end(), other.patches.begin(), other.patches.end());
  if (other.names.size() > names.size()) names = other.names;
}

Soup Soup::mapped(const std::function<Vec3(const Vec3&)>& map) const {
  Soup out = *this;
  for (Vec3& p : out.points) p = map(p);
  return out;
}

Soup Soup::flipped(unsigned seed) const {
  Soup out = *this;
  std::mt19937_64 generator(seed);
  for (auto& t : out.triangles)
    if (generator() % 2 == 0) std::swap(t[1], t[2]);
  return out;
}

std::unique_ptr<SurfaceModel> Soup::model() const {
  return std::make_unique<SurfaceModel>(points, triangles, patches, names);
}

Soup cube(int n, bool sidesArePatches) {
  Soup soup;
  if (sidesArePatches) soup.names = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  for (int axis = 0; axis < 3; ++axis)
    for (int upper = 0; upper < 2; ++upper) {
      const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
      const Vec3 origin = upper ? Vec3(Vec3::Unit(axis)) : Vec3(Vec3::Zero());
      soup.addGrid(origin, upper ? u : v, upper ? v : u, n, sidesArePatches ? 2 * axis + upper : 0);
    }
  return soup;
}

Soup cylinder(int facets) {
  Soup soup;
  for (int i = 0; i < facets; ++i) {
    const Vec3 a = onCircle(i, facets, -1), b = onCircle(i + 1, facets, -1);
    const Vec3 c = onCircle(i, facets, 1), d = onCircle(i + 1, facets, 1);
    soup.add(a, b, d);
    soup.add(a, d, c);
    soup.add({0, 0, -1}, b, a);
    soup.add({0, 0, 1}, c, d);
  }
  return soup;
}

Soup disc(int facets) {
  Soup soup;
  for (int i = 0; i < facets; ++i) soup.add({0, 0, 0}, onCircle(i, facets, 0), onCircle(i + 1, facets, 0));
  return soup;
}

Soup randomSoup(int count, double size, unsigned seed, int needleEvery) {
  std::mt19937_64 generator(seed);
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = randomPoint(generator);
    const Vec3 b = a + size * randomPoint(generator, -1, 1);
    Vec3 c = a + size * randomPoint(generator, -1, 1);
    if (needleEvery > 0 && i % needleEvery == 0)
      c = a + randomPoint(generator)[0] * (b - a) + 1e-12 * size * randomPoint(generator, -1, 1);
    soup.add(a, b, c);
  }
  return soup;
}

Vec3 randomPoint(std::mt19937_64& generator, double lo, double hi) {
  const auto next = [&] { return lo + (hi - lo) * (static_cast<double>(generator() >> 11) * 0x1p-53); };
  const double x = next(), y = next(), z = next();
  return {x, y, z};
}

void withThreads(int count, const std::function<void()>& body) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
  body();
}

}  // namespace pm::testing
