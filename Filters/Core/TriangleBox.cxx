// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleBox.h"

#include <Eigen/Geometry>
#include <array>
#include <utility>

namespace pm {

bool touches(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c, double slack) {
  const Vec3 centre = box.centre(), half = 0.5 * box.size() + Vec3::Constant(slack);
  const Vec3 p[3] = {a - centre, b - centre, c - centre};
  for (int k = 0; k < 3; ++k) {
    const double lo = std::min({p[0][k], p[1][k], p[2][k]}), hi = std::max({p[0][k], p[1][k], p[2][k]});
    if (lo > half[k] || hi < -half[k]) return false;
  }
  const Vec3 edge[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec3 normal = edge[0].cross(edge[1]);
  if (std::abs(normal.dot(p[0])) > normal.cwiseAbs().dot(half)) return false;
  for (const Vec3& e : edge) {
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;  // axis = unit(k) x e
      double lo = std::numeric_limits<double>::infinity(), hi = -lo;
      for (const Vec3& q : p) {
        const double d = -e[v] * q[u] + e[u] * q[v];
        lo = std::min(lo, d);
        hi = std::max(hi, d);
      }
      const double radius = std::abs(e[v]) * half[u] + std::abs(e[u]) * half[v];
      if (lo > radius || hi < -radius) return false;
    }
  }
  return true;
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
