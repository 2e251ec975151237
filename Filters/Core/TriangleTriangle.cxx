// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleTriangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "ExactPredicates.h"

namespace pm {

namespace {

using Triangle = SurfaceModel::Triangle;
using Signs = std::array<int, 3>;

bool has(const Triangle& t, Id p) { return t[0] == p || t[1] == p || t[2] == p; }

int sharedPoints(const Triangle& a, const Triangle& b) { return has(b, a[0]) + has(b, a[1]) + has(b, a[2]); }

MeetingPoint corner(Id p) { return {{p, kNone, kNone, kNone, kNone}}; }

MeetingPoint edgeAndTriangle(Id e0, Id e1, Triangle t) {
  std::sort(t.begin(), t.end());
  return {{std::min(e0, e1), std::max(e0, e1), t[0], t[1], t[2]}};
}

MeetingPoint edgeAndEdge(Id e0, Id e1, Id f0, Id f1) {
  std::pair<Id, Id> e = std::minmax(e0, e1), f = std::minmax(f0, f1);
  if (f < e) std::swap(e, f);
  return {{e.first, e.second, f.first, f.second, kNone}};
}

void add(TriangleContact& contact, const MeetingPoint& at) {
  for (int i = 0; i < contact.count; ++i)
    if (contact.ends[i] == at) return;
  if (contact.count == 2) throw InternalError("Two triangles in different planes meet in three points.");
  contact.ends[contact.count++] = at;
}

// Rounding of a difference and of a dot product of three terms, with room to spare.
constexpr double kSpokeNoise = 16 * std::numeric_limits<double>::epsilon();

class Pair {
 public:
  Pair(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b)
      : points_(points), a_(a), b_(b) {}

  TriangleContact contact() const {
    TriangleContact out;
    const int shared = sharedPoints(a_, b_);
    if (shared == 2) return hinge();
    if (shared == 1 && pointApart()) return out;
    const Signs ofB = sides(a_, b_);
    if (isAside(ofB, shared)) return out;
    const Signs ofA = sides(b_, a_);
    if (isAside(ofA, shared)) return out;
    if (zeros(ofA) == 3) {
      if (overlaps()) out.kind = Contact::Overlap;
      return out;
    }
    addEnds(a_, ofA, b_, out);
    addEnds(b_, ofB, a_, out);
    if (out.count == 2)
      out.kind = zeros(ofA) == 2 || zeros(ofB) == 2 ? Contact::Edge : Contact::Crossing;
    else if (out.count == 1 && shared == 0)
      out.kind = Contact::Point;
    else
      out.count = 0;
    return out;
  }

 private:
  const Vec3& at(Id p) const { return points_[p]; }

  static int zeros(const Signs& s) { return (s[0] == 0) + (s[1] == 0) + (s[2] == 0); }

  /// Wholly on one side of the other's plane, but perhaps for a common corner.
  static bool isAside(const Signs& s, int shared) {
    const int sum = s[0] + s[1] + s[2];
    return sum + shared >= 3 || sum - shared <= -3;
  }

  /// Sides of the plane of t on which the points of other lie.
  Signs sides(const Triangle& t, const Triangle& other) const {
    Signs out;
    for (int k = 0; k < 3; ++k)
      out[k] = has(t, other[k]) ? 0 : orient3d(at(t[0]), at(t[1]), at(t[2]), at(other[k]));
    return out;
  }

  /// Does a plane through the common corner, half-way between the triangles, keep them apart? Any plane will
  /// do, so its own rounding is no matter; most neighbours, and nearly all of a fan, are settled here.
  bool pointApart() const {
    std::array<Vec3, 2> a, b;
    const Vec3 middleA = spokes(a_, b_, a), middleB = spokes(b_, a_, b);
    const Vec3 across = middleA - middleB;
    const double noise = kSpokeNoise * across.norm();
    for (int k = 0; k < 2; ++k)
      if (!(across.dot(a[k]) > noise * a[k].norm()) || !(across.dot(b[k]) < -noise * b[k].norm()))
        return false;
    return true;
  }

  /// Edges of t from the corner it has in common with the other; returns the unit direction between them.
  Vec3 spokes(const Triangle& t, const Triangle& other, std::array<Vec3, 2>& edges) const {
    const int k = has(other, t[0]) ? 0 : has(other, t[1]) ? 1 : 2;
    for (int i = 0; i < 2; ++i) edges[i] = at(t[(k + 1 + i) % 3]) - at(t[k]);
    return (edges[0].normalized() + edges[1].normalized()).normalized();
  }

  /// Triangles with a common edge meet elsewhere only when one is folded onto the other.
  TriangleContact hinge() const {
    Triangle edge{};
    Id apexA = kNone, apexB = kNone;
    int found = 0;
    for (Id p : a_) {
      if (has(b_, p))
        edge[found++] = p;
      else
        apexA = p;
    }
    for (Id p : b_)
      if (!has(a_, p)) apexB = p;
    TriangleContact out;
    const Vec3 &p = at(edge[0]), &q = at(edge[1]);
    if (orient3d(p, q, at(apexA), at(apexB)) != 0) return out;
    const int axis = planeAxis(a_);
    if (orient2d(p, q, at(apexA), axis) == orient2d(p, q, at(apexB), axis)) out.kind = Contact::Overlap;
    return out;
  }

  /// An axis along which the triangle is seen with an area.
  int planeAxis(const Triangle& t) const {
    const Vec3 &p = at(t[0]), &q = at(t[1]), &r = at(t[2]);
    int axis;
    (q - p).cross(r - p).cwiseAbs().maxCoeff(&axis);
    for (int k = 0; k < 2 && orient2d(p, q, r, axis) == 0; ++k) axis = (axis + 1) % 3;
    return axis;
  }

  /// Do triangles in one plane have an area in common? Not when a line along an edge separates them.
  bool overlaps() const {
    const int axis = planeAxis(a_);
    return !isSeparatedByEdge(a_, b_, axis) && !isSeparatedByEdge(b_, a_, axis);
  }

  bool isSeparatedByEdge(const Triangle& t, const Triangle& other, int axis) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &p = at(t[k]), &q = at(t[(k + 1) % 3]);
      const int inside = orient2d(p, q, at(t[(k + 2) % 3]), axis);
      bool apart = true;
      for (int i = 0; i < 3 && apart; ++i) apart = inside * orient2d(p, q, at(other[i]), axis) <= 0;
      if (apart) return true;
    }
    return false;
  }

  /// Ends of the common segment where the border of t meets the other triangle.
  void addEnds(const Triangle& t, const Signs& side, const Triangle& other, TriangleContact& out) const {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (side[k] == 0 && contains(other, t[k])) add(out, corner(t[k]));
      if (side[k] * side[next] < 0) pierce(t[k], t[next], other, out);
    }
  }

  /// Point of the triangle's plane inside it or on its border?
  bool contains(const Triangle& t, Id p) const {
    if (has(t, p)) return true;
    const int axis = planeAxis(t);
    int lowest = 1, highest = -1;
    for (int k = 0; k < 3; ++k) {
      const int s = orient2d(at(t[k]), at(t[(k + 1) % 3]), at(p), axis);
      lowest = std::min(lowest, s);
      highest = std::max(highest, s);
    }
    return lowest * highest >= 0;
  }

  /// An edge with its ends on both sides of the plane of t.
  void pierce(Id e0, Id e1, const Triangle& t, TriangleContact& out) const {
    Signs s;
    for (int k = 0; k < 3; ++k) s[k] = orient3d(at(e0), at(e1), at(t[k]), at(t[(k + 1) % 3]));
    const auto [lowest, highest] = std::minmax({s[0], s[1], s[2]});
    if (lowest * highest < 0) return;
    if (zeros(s) == 0) return add(out, edgeAndTriangle(e0, e1, t));
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (zeros(s) == 1 && s[k] == 0) add(out, edgeAndEdge(e0, e1, t[k], t[next]));
      if (zeros(s) == 2 && s[k] == 0 && s[next] == 0) add(out, corner(t[next]));
    }
  }

  const std::vector<Vec3>& points_;
  const Triangle &a_, &b_;
};

}  // namespace

TriangleContact contactOf(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b) {
  return Pair(points, a, b).contact();
}

Vec3 positionOf(const std::vector<Vec3>& points, const MeetingPoint& at) {
  const Vec3& from = points[at.ids[0]];
  if (at.isCorner()) return from;
  const Vec3& to = points[at.ids[1]];
  const Vec3 &p = points[at.ids[2]], &q = points[at.ids[3]];
  double before = 0, after = 0;
  if (at.isEdgePair()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double x = area2d(p, q, from, axis), y = area2d(p, q, to, axis);
      if (std::abs(x - y) <= std::abs(before - after)) continue;
      before = x;
      after = y;
    }
  } else {
    const Vec3& r = points[at.ids[4]];
    before = volume3d(p, q, r, from);
    after = volume3d(p, q, r, to);
  }
  return from + (before / (before - after)) * (to - from);
}

}  // namespace pm
