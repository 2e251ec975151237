// SPDX-License-Identifier: BSD-3-Clause
// Triangle and segment against an axis-aligned box: do they touch, and where is the piece inside.
#pragma once

#include "Types.h"

namespace pm {

/// Separating-axis test, conservative: a triangle that touches the box within `slack` (length) counts as
/// overlapping, and rounding never hides one that does, be it a sliver or many times larger than the box.
bool touches(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c, double slack);

/// The planes that bound the eight children of a cell along each axis.
struct ChildPlanes {
  Vec3 lo, middle, hi;
};

/// Which children of a cell the triangle touches within `slack`: bit x + 2 y + 4 z, with x, y, z = 1 for the
/// upper half. The same test as touches(), but what the children have in common is computed once, and a
/// triangle wholly inside the cell and across at most one of its middle planes needs no more than its box.
std::uint8_t touchedChildren(const ChildPlanes& cell, const Vec3& a, const Vec3& b, const Vec3& c,
                             double slack);

/// Does the segment a-b touch the box?
bool touches(const Box& box, const Vec3& a, const Vec3& b);

/// Average corner of the part of the triangle inside the box (the "centre of the cut figure", thesis Fig.
/// 3-20); the nearest point of the triangle's box when rounding leaves nothing.
Vec3 cutCentre(const Box& box, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace pm
