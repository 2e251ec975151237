// SPDX-License-Identifier: BSD-3-Clause
// How two triangles of a soup meet, decided exactly.
//
// The ends of a common segment are named by what meets there (a point of one triangle, an edge and a
// triangle, two edges), by point ids alone. Neighbouring pairs name an end they have in common alike and
// compute the same bits for it, so segments join into curves by name. Source of the case analysis: A. Guigue
// and O. Devillers, Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates, 2003, with
// zeros kept apart.
#pragma once

#include "SurfaceModel.h"

namespace pm {

enum class Contact : std::uint8_t {
  None,      ///< apart, or neighbours that share a point or an edge and nothing else
  Point,     ///< touch in one point that is not a common corner
  Edge,      ///< meet along a segment that lies on an edge of at least one of them
  Crossing,  ///< meet along a segment through the inside of both
  Overlap    ///< in one plane, with a common area
};

/// Where two triangles meet. Ids of points of the model; unused ones are kNone.
/// A point: {p}. An edge and a triangle: {e0, e1, t0, t1, t2}. Two edges: {e0, e1, f0, f1}. All ascending.
struct MeetingPoint {
  std::array<Id, 5> ids{kNone, kNone, kNone, kNone, kNone};
  bool isCorner() const { return ids[1] == kNone; }
  bool isEdgePair() const { return ids[3] != kNone && ids[4] == kNone; }
  bool operator==(const MeetingPoint& o) const { return ids == o.ids; }
  bool operator<(const MeetingPoint& o) const { return ids < o.ids; }
};

struct TriangleContact {
  Contact kind = Contact::None;
  int count = 0;  ///< ends: 1 for Contact::Point, 2 for Edge and Crossing
  std::array<MeetingPoint, 2> ends;
};

/// Triangles must have an area and must not be the same three points.
TriangleContact contactOf(const std::vector<Vec3>& points, const SurfaceModel::Triangle& a,
                          const SurfaceModel::Triangle& b);

/// Position of a meeting point; depends on the name alone.
Vec3 positionOf(const std::vector<Vec3>& points, const MeetingPoint& at);

}  // namespace pm
