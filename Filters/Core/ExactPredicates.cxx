// SPDX-License-Identifier: BSD-3-Clause
#include "ExactPredicates.h"

#include <array>
#include <cmath>

namespace pm {

namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon() / 2;
// Shewchuk's bounds (7 + 56 u) u and (3 + 16 u) u, rounded up.
constexpr double kVolumeBound = 8 * kRoundoff;
constexpr double kAreaBound = 4 * kRoundoff;

int sign(double v) { return (v > 0) - (v < 0); }

/// A sum of up to N doubles that do not overlap, in ascending magnitude, none zero.
template <int N>
struct Expansion {
  std::array<double, N> term;
  int size = 0;

  void push(double v) {
    if (v != 0) term[size++] = v;
  }
  int sign() const { return size == 0 ? 0 : pm::sign(term[size - 1]); }
  double rounded() const {
    double sum = 0;
    for (int i = 0; i < size; ++i) sum += term[i];
    return sum;
  }
};

/// a + b = sum + error, without rounding.
void twoSum(double a, double b, double& sum, double& error) {
  sum = a + b;
  const double fromB = sum - a;
  error = (a - (sum - fromB)) + (b - fromB);
}

void twoProduct(double a, double b, double& product, double& error) {
  product = a * b;
  error = std::fma(a, b, -product);
}

Expansion<2> difference(double a, double b) {
  double head, tail;
  twoSum(a, -b, head, tail);
  Expansion<2> out;
  out.push(tail);
  out.push(head);
  return out;
}

template <int N, int M>
Expansion<N + M> sum(const Expansion<N>& e, const Expansion<M>& f, double signOfF = 1) {
  Expansion<N + M> out;
  for (int i = 0; i < e.size; ++i) out.push(e.term[i]);
  for (int j = 0; j < f.size; ++j) {
    double carry = signOfF * f.term[j];
    const int count = out.size;
    out.size = 0;
    for (int i = 0; i < count; ++i) {
      double error;
      twoSum(carry, out.term[i], carry, error);
      out.push(error);
    }
    out.push(carry);
  }
  return out;
}

template <int N>
Expansion<2 * N> scaled(const Expansion<N>& e, double factor) {
  Expansion<2 * N> out;
  double carry = 0, error;
  for (int i = 0; i < e.size; ++i) {
    double head, tail, middle;
    twoProduct(e.term[i], factor, head, tail);
    twoSum(carry, tail, middle, error);
    out.push(error);
    twoSum(head, middle, carry, error);
    out.push(error);
  }
  out.push(carry);
  return out;
}

template <int N>
Expansion<4 * N> product(const Expansion<N>& e, const Expansion<2>& f) {
  if (f.size == 0) return {};
  const Expansion<2 * N> first = scaled(e, f.term[0]);
  return sum(first, f.size == 2 ? scaled(e, f.term[1]) : Expansion<2 * N>{});
}

using Difference = std::array<Expansion<2>, 3>;

Difference difference(const Vec3& to, const Vec3& from) {
  return {difference(to[0], from[0]), difference(to[1], from[1]), difference(to[2], from[2])};
}

/// Component `axis` of u x v.
Expansion<16> crossComponent(const Difference& u, const Difference& v, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  return sum(product(u[i], v[j]), product(u[j], v[i]), -1);
}

Expansion<192> exactVolume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Difference u = difference(b, a), v = difference(c, a), w = difference(d, a);
  const auto x = product(crossComponent(u, v, 0), w[0]);
  const auto y = product(crossComponent(u, v, 1), w[1]);
  const auto z = product(crossComponent(u, v, 2), w[2]);
  return sum(sum(x, y), z);
}

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  double volume = 0, bound = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double plus = u[i] * v[j], minus = u[j] * v[i];
    volume += (plus - minus) * w[axis];
    bound += (std::abs(plus) + std::abs(minus)) * std::abs(w[axis]);
  }
  if (std::abs(volume) > kVolumeBound * bound) return sign(volume);
  return bound == 0 ? 0 : exactVolume(a, b, c, d).sign();
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double plus = (b[i] - a[i]) * (c[j] - a[j]), minus = (b[j] - a[j]) * (c[i] - a[i]);
  const double bound = std::abs(plus) + std::abs(minus);
  if (std::abs(plus - minus) > kAreaBound * bound) return sign(plus - minus);
  return bound == 0 ? 0 : crossComponent(difference(b, a), difference(c, a), axis).sign();
}

double volume3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return exactVolume(a, b, c, d).rounded();
}

double area2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  return crossComponent(difference(b, a), difference(c, a), axis).rounded();
}

}  // namespace pm
