// SPDX-License-Identifier: BSD-3-Clause
// Triangle soups made by hand for the kernel's tests.
#pragma once

#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "SurfaceModel.h"

namespace pm::testing {

struct Soup {
  std::vector<Vec3> points;
  std::vector<SurfaceModel::Triangle> triangles;
  std::vector<Id> patches;
  std::vector<std::string> names{"wall"};

  /// Adds a triangle with points of its own.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, Id patch = 0);
  /// Adds n by n squares of two triangles over the parallelogram origin, u, v.
  void addGrid(const Vec3& origin, const Vec3& u, const Vec3& v, int n, Id patch = 0);
  void append(const Soup& other);
  Soup mapped(const std::function<Vec3(const Vec3&)>& map) const;
  /// Some triangles turned around.
  Soup flipped(unsigned seed) const;
  std::unique_ptr<SurfaceModel> model() const;
};

/// Unit cube, each side n by n squares; patch of side s (xmin, xmax, .. zmax) is s when sidesArePatches.
Soup cube(int n = 1, bool sidesArePatches = false);
/// Closed cylinder about z, radius 1, height 2, `facets` around.
Soup cylinder(int facets);
/// Flat disc of radius 1 about the origin in z = 0.
Soup disc(int facets);
/// Triangles of about the given size thrown into the unit cube; every `needleEvery`-th is a needle, 0 for
/// none.
Soup randomSoup(int count, double size, unsigned seed, int needleEvery = 0);

Vec3 randomPoint(std::mt19937_64& generator, double lo = 0, double hi = 1);

/// Runs the body with at most that many threads.
void withThreads(int count, const std::function<void()>& body);

}  // namespace pm::testing
