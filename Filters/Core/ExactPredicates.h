// SPDX-License-Identifier: BSD-3-Clause
// Signs of determinants of points, exact for doubles.
//
// A floating-point value decides where its error bound allows; else the determinant is evaluated without any
// rounding as an expansion, a sum of doubles that do not overlap (J. R. Shewchuk, Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997). Exact as long as differences of
// coordinates are zero or between 1e-70 and 1e70, where no product over- or underflows.
#pragma once

#include "Types.h"

namespace pm {

/// Sign of the volume det(b - a, c - a, d - a): on which side of the plane abc is d? 0 when on it.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of abc seen along an axis: (b - a) x (c - a), component `axis`.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// The same determinants, computed exactly and rounded at the end.
double volume3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double area2d(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

}  // namespace pm
