// SPDX-License-Identifier: BSD-3-Clause
// Where the triangles of a soup cut each other.
//
// Candidates are pairs with overlapping boxes, found through a hierarchy of boxes; what a pair is, is decided
// exactly (TriangleTriangle.h). Neighbours that share a point or an edge count only where they meet beyond
// it. Time grows with the number of triangles and of such pairs. The same bits for any number of threads.
#pragma once

#include "Monitor.h"
#include "TriangleTriangle.h"

namespace pm {

/// Two triangles, a < b, that meet.
struct TrianglePair {
  Id a, b;
  Contact contact;
};

/// The segment along which triangles a and b of different planes meet.
struct IntersectionSegment {
  Id a, b;          ///< triangles, a < b
  Id start, end;    ///< rows of SelfIntersections::points, start < end
  Contact contact;  ///< Crossing or Edge
};

struct SelfIntersections {
  std::vector<MeetingPoint> names;            ///< #P, each once, ascending
  std::vector<Vec3> points;                   ///< #P
  std::vector<IntersectionSegment> segments;  ///< ascending (a, b)
  std::vector<TrianglePair> pairs;            ///< all that meet, ascending (a, b)
};

SelfIntersections selfIntersections(const SurfaceModel& model, Monitor& monitor);

}  // namespace pm
