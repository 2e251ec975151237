// SPDX-License-Identifier: BSD-3-Clause
// Closest point on an edge, shared by triangles and feature segments so that both agree to the bit.
#pragma once

#include "Types.h"

namespace pm {

/// Replaces best.point and best.distance2 when the offered point is nearer.
template <class Best>
void keepCloser(Best& best, const Vec3& point, double distance2) {
  if (distance2 < best.distance2) {
    best.point = point;
    best.distance2 = distance2;
  }
}

/// Offers the point of a-b closest to p. An end is compared as a point: all edges at a corner give the same
/// distance. Works relative to a, so nothing is lost far from the origin; an edge without length is a point.
template <class Best>
void closestOnEdge(const Vec3& p, const Vec3& a, const Vec3& b, Best& best) {
  const Vec3 d = b - a, ap = p - a;
  const double along = ap.dot(d), length2 = d.squaredNorm();
  if (!(along > 0)) return keepCloser(best, a, ap.squaredNorm());
  if (along >= length2) return keepCloser(best, b, (p - b).squaredNorm());
  const Vec3 r = (along / length2) * d;
  keepCloser(best, a + r, (ap - r).squaredNorm());
}

}  // namespace pm
