// SPDX-License-Identifier: BSD-3-Clause
// Feature edges before they are curves: a graph of points and links, and the passes that make and consume it.
// Internal to feature detection (FeatureEdges.h).
#pragma once

#include <cmath>

#include "Bvh.h"
#include "FeatureEdges.h"

namespace pm {

constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;

/// Degrees between unit vectors, accurate for small and for flat angles.
inline double angleBetween(const Vec3& u, const Vec3& v) {
  return 2 * std::atan2((u - v).norm(), (u + v).norm()) * kDegreesPerRadian;
}

struct FeatureNetwork {
  struct Link {
    Id a, b;            // a < b
    std::uint8_t kind;  // FeatureKind bits
  };
  using Links = std::vector<Link>;
  std::vector<Vec3> points;  // the model's, by the same ids, then those of intersections; welding moves some
  Links links;               // each pair of points once, ascending
};

/// Each pair of points once, ascending, with the kinds of all its links.
void unifyLinks(FeatureNetwork::Links& links);

/// Splits links at points beside them; splits: (row of the link, point), any order.
void splitLinks(const std::vector<Vec3>& points, FeatureNetwork::Links& links,
                std::vector<std::pair<Id, Id>> splits);

/// A place on a link.
struct LinkFoot {
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity();
  Id link = kNone;
};

/// Finds the nearest place on some links; ties go to the first link. Thread-safe.
class LinkLookup {
 public:
  LinkLookup(const std::vector<Vec3>& points, const FeatureNetwork::Links& links);
  /// Nothing farther than the square root of bound2; of links within 30 degrees of the direction only, when
  /// it is not zero.
  LinkFoot nearest(const Vec3& p, double bound2, const Vec3& direction = Vec3::Zero()) const;
  /// Would nearest() find anything? Ends with the first link that will do.
  bool reaches(const Vec3& p, double bound2, const Vec3& direction = Vec3::Zero()) const;

 private:
  bool isAlong(Id link, const Vec3& direction) const;

  const std::vector<Vec3>& points_;
  const FeatureNetwork::Links& links_;
  Bvh bvh_;
};

/// An edge of one triangle only.
struct OpenEdge {
  Id a, b;  // a < b
  Id triangle;
};

/// Which open edges are features: all on request, else those near geometry they ought to be stitched to.
std::vector<OpenEdge> chooseOpenEdges(const SurfaceModel& model, std::vector<OpenEdge> open,
                                      const FeatureOptions& options);

struct IntersectionTolerances {
  double joining;  // curves within it of links are those links, ends within it join them
  double trusted;  // triangles lower than this have no plane: they only carry on curves of their neighbours
};

/// Adds the curves along which triangles in planes at more than the sharp angle cut each other. Pieces that
/// run along links already there within the tolerance, and curves shorter than it, say nothing and are left
/// out; ends within the tolerance of a link join it. Links and open edges are split where curves meet them.
void addIntersections(const SurfaceModel& model, const FeatureOptions& options,
                      const IntersectionTolerances& tolerances, FeatureNetwork& network,
                      std::vector<OpenEdge>& open, Monitor& monitor);

/// Adds the polylines of FeatureOptions::given, fitted to what is there in the same way.
void addGivenCurves(const SurfaceModel& model, const FeatureOptions& options,
                    const IntersectionTolerances& tolerances, FeatureNetwork& network,
                    std::vector<OpenEdge>& open);

/// Adds open edges to the network. Borders within the tolerance of each other or of links already there are
/// welded into one line: points join points, then points split the links they lie on, then equal links are
/// one.
void addOpenEdges(FeatureNetwork& network, const std::vector<OpenEdge>& open, double tolerance);

/// Joins links into curves between corners. Turning is measured over at least `reach` on both sides of a
/// point, so that the rounding of nearly coincident points makes no corners.
FeatureGraph traceCurves(const FeatureNetwork& network, const FeatureOptions& options, double reach);

}  // namespace pm
