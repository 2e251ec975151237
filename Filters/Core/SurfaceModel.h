// SPDX-License-Identifier: BSD-3-Clause
// The input geometry as the mesher sees it: a soup of triangles in patches, with an exact closest point.
//
// Nothing is assumed of the triangles but finite coordinates: they may overlap, intersect, repeat, be flipped
// or leave gaps. Points are merged only where they are bitwise equal; triangles of no area and exact
// repetitions are dropped.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "Types.h"

namespace pm {

class Bvh;

/// Answer of a closest-point query; triangle is kNone until something was found.
struct Closest {
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity();
  Id triangle = kNone;
};

/// Where the line from + t along meets the triangle: t, also below 0; infinity for a miss.
double rayHit(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c);

class SurfaceModel {
 public:
  using Triangle = std::array<Id, 3>;

  /// points: #P by 3 in the user's units; triangles: #T by 3 point ids; patchOfTriangle: #T ids into
  /// patchNames. Throws InputError when there are no triangles, a coordinate is not finite, or an id is out
  /// of range.
  SurfaceModel(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
               const std::vector<Id>& patchOfTriangle, std::vector<std::string> patchNames);
  ~SurfaceModel();
  SurfaceModel(const SurfaceModel&) = delete;
  SurfaceModel& operator=(const SurfaceModel&) = delete;

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<std::string>& patchNames() const { return patchNames_; }
  Id triangleCount() const { return static_cast<Id>(triangles_.size()); }
  Id patchOf(Id triangle) const { return patch_[triangle]; }
  const Vec3& normal(Id triangle) const { return normals_[triangle]; }  ///< unit length
  const Vec3& corner(Id triangle, int k) const { return points_[triangles_[triangle][k]]; }
  const Box& bounds() const { return bounds_; }
  /// Equal for equal content; keys caches and recognises changed geometry.
  std::uint64_t contentHash() const { return hash_; }

  /// Exact closest point; ties go to the smallest triangle id. seed, when given, must itself be a point of
  /// the model: it only prunes the search and never changes the answer. Any point nearer than `enough` will
  /// do where the closest is of no interest then. Thread-safe.
  Closest closest(const Vec3& p, const Closest& seed = {}, double enough = 0) const;
  /// The same where the distance is known to be at most `reach`; no triangle when that is wrong.
  Closest closestWithin(const Vec3& p, double reach) const;
  /// Closest point on one triangle.
  Closest closestOnTriangle(const Vec3& p, Id triangle) const;
  /// Ids of the triangles whose boxes overlap the box, ascending.
  std::vector<Id> trianglesNear(const Box& box) const;
  /// Does a triangle cross the segment, to rounding? Thread-safe.
  bool crosses(const Vec3& p, const Vec3& q) const;
  /// The part of the way from p to q at which a triangle is met first; infinity for none. Thread-safe.
  double firstCrossing(const Vec3& p, const Vec3& q) const;
  /// The tree over the triangles' boxes, for searches of one's own.
  const Bvh& hierarchy() const;

 private:
  template <class Bound>
  void search(const Vec3& p, Closest& best, const Bound& bound2) const;

  struct Hierarchy;  // bounding-volume tree over the triangles
  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;
  std::vector<Id> patch_;
  std::vector<Vec3> normals_;
  std::vector<std::string> patchNames_;
  Box bounds_;
  std::uint64_t hash_ = 0;
  std::unique_ptr<Hierarchy> tree_;
};

}  // namespace pm
