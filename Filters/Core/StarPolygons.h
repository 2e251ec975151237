// SPDX-License-Identifier: BSD-3-Clause
// Polygons in a plane as cells need them: with all triangles about their centre the right way round.
#pragma once

#include "Types.h"

namespace pm {

using Vec2 = Eigen::Vector2d;

/// Whether all triangles of a polygon about the mean of its corners run counter-clockwise and have an area
/// worth the name (2% of their mean). row: ids into points.
bool isStar(const std::vector<Vec2>& points, Span<Id> row);

/// The polygon in a few such parts, cut by the best diagonal again and again; empty when that cannot be,
/// because it is inside out or not simple. O(n^4) in the corners of one polygon, at worst.
std::vector<std::vector<Id>> cutIntoStars(const std::vector<Vec2>& points, Span<Id> row);

}  // namespace pm
