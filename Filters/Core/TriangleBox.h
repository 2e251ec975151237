// SPDX-License-Identifier: BSD-3-Clause
// Triangle and segment against an axis-aligned box: do they touch, and where is the piece inside.
#pragma once

#include "Types.h"

namespace pm {

/// Separating-axis test, conservative: a triangle that touches the box within `slack` (length) counts as
/// overlapping.
bool touches(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c, double slack);

/// Does the segment a-b touch the box?
bool touches(const Box& box, const Vec3& a, const Vec3& b);

/// Average corner of the part of the triangle inside the box (the "centre of the cut figure", thesis Fig.
/// 3-20); the nearest point of the triangle's box when rounding leaves nothing.
Vec3 cutCentre(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace pm
