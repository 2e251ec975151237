// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleBox.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pm {

namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Children in the upper half along each axis.
constexpr std::uint8_t kUpper[3] = {0xaa, 0xcc, 0xf0};

double least(double a, double b, double c) { return std::min(std::min(a, b), c); }
double most(double a, double b, double c) { return std::max(std::max(a, b), c); }

/// A triangle relative to a point near a box, with bounds of what rounding does to its separating axes.
struct NearTriangle {
  Vec3 p[3], edge[3], normal;
  double normalError, edgeError;

  NearTriangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& centre)
      : p{a - centre, b - centre, c - centre}, edge{p[1] - p[0], p[2] - p[1], p[0] - p[2]} {
    normal = edge[0].cross(edge[1]);
    const double reach = p[0].cwiseAbs().cwiseMax(p[1].cwiseAbs()).cwiseMax(p[2].cwiseAbs()).maxCoeff();
    edgeError = 16 * kEps * reach * reach;
    normalError = 64 * kEps * reach * reach * reach;
  }
  /// Extent along axis unit(k) x edge[i]; both ends of the edge have the same place on it.
  std::pair<double, double> extent(int i, int u, int v) const {
    const Vec3 &e = edge[i], &q = p[i], &r = p[(i + 2) % 3];
    return std::minmax(-e[v] * q[u] + e[u] * q[v], -e[v] * r[u] + e[u] * r[v]);
  }
};

}  // namespace

bool touches(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c, double slack) {
  for (int k = 0; k < 3; ++k)
    if (least(a[k], b[k], c[k]) > box.hi[k] + slack || most(a[k], b[k], c[k]) < box.lo[k] - slack)
      return false;
  const NearTriangle t(a, b, c, box.centre());
  const Vec3 half = 0.5 * box.size() + Vec3::Constant(slack);
  if (std::abs(t.normal.dot(t.p[0])) > t.normal.cwiseAbs().dot(half) + t.normalError) return false;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const auto [lo, hi] = t.extent(i, u, v);
      const double radius = std::abs(t.edge[i][v]) * half[u] + std::abs(t.edge[i][u]) * half[v] + t.edgeError;
      if (lo > radius || hi < -radius) return false;
    }
  return true;
}

std::uint8_t touchedChildren(const ChildPlanes& cell, const Vec3& a, const Vec3& b, const Vec3& c,
                             double slack) {
  std::uint8_t children = 0xff;
  bool inside = true;
  int crossed = 0;
  for (int k = 0; k < 3; ++k) {
    const double lo = least(a[k], b[k], c[k]), hi = most(a[k], b[k], c[k]);
    inside = inside && lo >= cell.lo[k] && hi <= cell.hi[k];
    const bool lower = lo <= cell.middle[k] + slack && hi >= cell.lo[k] - slack;
    const bool upper = hi >= cell.middle[k] - slack && lo <= cell.hi[k] + slack;
    crossed += lower && upper;
    children &= (lower ? ~kUpper[k] & 0xff : 0) | (upper ? kUpper[k] : 0);
  }
  if (children == 0 || (inside && crossed <= 1)) return children;

  const NearTriangle t(a, b, c, cell.middle);
  const Vec3 centre = 0.5 * (cell.middle - cell.lo).cwiseMax(cell.hi - cell.middle);  // of the upper child
  const Vec3 half = centre + Vec3::Constant(slack);
  const Vec3 step = t.normal.cwiseProduct(centre);
  const double place = t.normal.dot(t.p[0]), radius = t.normal.cwiseAbs().dot(half) + t.normalError;
  for (int m = 0; m < 8; ++m) {
    const double shift =
        (m & 1 ? step[0] : -step[0]) + (m & 2 ? step[1] : -step[1]) + (m & 4 ? step[2] : -step[2]);
    if (std::abs(place - shift) > radius) children &= ~(1u << m);
  }
  for (int i = 0; i < 3 && children != 0; ++i)
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const double eu = t.edge[i][u], ev = t.edge[i][v];
      const auto [lo, hi] = t.extent(i, u, v);
      const double reach = std::abs(ev) * half[u] + std::abs(eu) * half[v] + t.edgeError;
      for (int m = 0; m < 4; ++m) {
        const double shift = (m & 1 ? -ev : ev) * centre[u] + (m & 2 ? eu : -eu) * centre[v];
        if (lo - shift > reach || hi - shift < -reach)
          children &= ~((m & 1 ? kUpper[u] : ~kUpper[u]) & (m & 2 ? kUpper[v] : ~kUpper[v]));
      }
    }
  return children;
}

bool touches(const Box& box, const Vec3& a, const Vec3& b) {
  double t0 = 0, t1 = 1;
  for (int k = 0; k < 3; ++k) {
    const double d = b[k] - a[k];
    double near = box.lo[k] - a[k], far = box.hi[k] - a[k];
    if (d == 0) {
      if (near > 0 || far < 0) return false;
      continue;
    }
    near /= d;
    far /= d;
    if (near > far) std::swap(near, far);
    t0 = std::max(t0, near);
    t1 = std::min(t1, far);
    if (t0 > t1) return false;
  }
  return true;
}

Vec3 cutCentre(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c) {
  std::array<Vec3, 9> polygon{a, b, c}, clipped;  // a triangle cut by six planes has nine corners at most
  int n = 3;
  for (int side = 0; side < 6 && n > 0; ++side) {
    const int k = side / 2;
    const double sign = side % 2 ? -1 : 1, plane = side % 2 ? box.hi[k] : box.lo[k];
    int m = 0;
    for (int i = 0; i < n; ++i) {
      const Vec3 &p = polygon[i], &q = polygon[(i + 1) % n];
      const double dp = sign * (p[k] - plane), dq = sign * (q[k] - plane);
      if (dp >= 0 && m < 9) clipped[m++] = p;
      if ((dp >= 0) != (dq >= 0) && m < 9) clipped[m++] = p + (q - p) * (dp / (dp - dq));
    }
    n = m;
    polygon = clipped;
  }
  Vec3 sum = Vec3::Zero();
  if (n == 0) return ((a + b + c) / 3).cwiseMax(box.lo).cwiseMin(box.hi);
  for (int i = 0; i < n; ++i) sum += polygon[i];
  return sum / n;
}

}  // namespace pm
