// SPDX-License-Identifier: BSD-3-Clause
// Arithmetic on the four corners of a quadrilateral at once: most faces of a mesh are quads, and what is
// measured of them is the same for each corner. Written with the vector types that GCC and Clang share; two
// numbers a register, which every 64-bit x86 and ARM has, so results are the same bits on all of one kind.
#pragma once

#include <cmath>

#include "Types.h"

namespace pm {

/// One number for each corner.
struct Four {
  using Two = double __attribute__((vector_size(16)));
  Two lo, hi;

  static Four all(double v) { return {Two{v, v}, Two{v, v}}; }
  friend Four operator+(const Four& a, const Four& b) { return {a.lo + b.lo, a.hi + b.hi}; }
  friend Four operator-(const Four& a, const Four& b) { return {a.lo - b.lo, a.hi - b.hi}; }
  friend Four operator*(const Four& a, const Four& b) { return {a.lo * b.lo, a.hi * b.hi}; }
  friend Four operator/(const Four& a, const Four& b) { return {a.lo / b.lo, a.hi / b.hi}; }
  friend Four operator*(double s, const Four& a) { return all(s) * a; }
  friend Four operator+(const Four& a, double s) { return a + all(s); }
  friend Four operator-(const Four& a, double s) { return a - all(s); }

  /// Each corner's predecessor's number.
  Four before() const {
    return {__builtin_shufflevector(hi, lo, 1, 2), __builtin_shufflevector(lo, hi, 1, 2)};
  }
  /// That of the corner across.
  Four across() const { return {hi, lo}; }
  double sum() const {
    const Two s = lo + hi;
    return s[0] + s[1];
  }
  double least() const {
    const Two s = lo < hi ? lo : hi;
    return s[0] < s[1] ? s[0] : s[1];
  }
  double most() const {
    const Two s = lo > hi ? lo : hi;
    return s[0] > s[1] ? s[0] : s[1];
  }
};

inline Four larger(const Four& a, const Four& b) {
  return {a.lo > b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi};
}
inline Four squareRoot(const Four& a) {
  return {Four::Two{std::sqrt(a.lo[0]), std::sqrt(a.lo[1])},
          Four::Two{std::sqrt(a.hi[0]), std::sqrt(a.hi[1])}};
}

/// One vector for each corner.
struct FourVectors {
  Four x, y, z;

  friend FourVectors operator+(const FourVectors& a, const FourVectors& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend FourVectors operator-(const FourVectors& a, const FourVectors& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend FourVectors operator-(const FourVectors& a, const Vec3& v) {
    return {a.x - v[0], a.y - v[1], a.z - v[2]};
  }
  friend FourVectors operator*(const Four& s, const FourVectors& a) { return {s * a.x, s * a.y, s * a.z}; }
  FourVectors before() const { return {x.before(), y.before(), z.before()}; }
  FourVectors across() const { return {x.across(), y.across(), z.across()}; }
  FourVectors cross(const FourVectors& b) const {
    return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
  }
  Four dot(const FourVectors& b) const { return x * b.x + y * b.y + z * b.z; }
  Four dot(const Vec3& v) const { return v[0] * x + v[1] * y + v[2] * z; }
  Four length() const { return squareRoot(dot(*this)); }
  Vec3 sum() const { return {x.sum(), y.sum(), z.sum()}; }
};

/// The corners of a quad relative to a point.
inline FourVectors quadCorners(const std::vector<Vec3>& points, Span<Id> row, const Vec3& origin) {
  const Vec3 &a = points[row[0]], &b = points[row[1]], &c = points[row[2]], &d = points[row[3]];
  const auto along = [&](int axis) {
    return Four{Four::Two{a[axis], b[axis]}, Four::Two{c[axis], d[axis]}} - origin[axis];
  };
  return {along(0), along(1), along(2)};
}

}  // namespace pm
