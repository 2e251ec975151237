// SPDX-License-Identifier: BSD-3-Clause
// Critical edges and corners of the input (thesis 4.7.1), joined into curves between corners.
#pragma once

#include <memory>

#include "Monitor.h"
#include "SurfaceModel.h"

namespace pm {

struct FeatureOptions {
  double sharpAngle =
      30;  ///< degrees between the planes of two triangles at an edge; independent of orientation
  double cornerAngle = 45;    ///< degrees a curve may turn at a point before the point becomes a corner
  bool interfaces = true;     ///< edges between patches are features
  bool openEdges = false;     ///< every open edge is a feature
  bool intersections = true;  ///< curves where the surface cuts itself at more than sharpAngle are features
  double gapTolerance =
      0;  ///< length; an open edge this close to a triangle whose plane differs by more than
          ///< sharpAngle, or to one of another patch, is a feature too (unstitched geometry)
  double shortestCurve = 0;              ///< length; shorter open-ended curves that join nothing are dropped
  std::vector<std::vector<Vec3>> given;  ///< polylines on the surface that are features too; a closed one
                                         ///< repeats its first point
};

enum FeatureKind : std::uint8_t {
  kSharpEdge = 1,
  kInterfaceEdge = 2,
  kOpenEdge = 4,
  kNonManifoldEdge = 8,
  kIntersectionEdge = 16,  ///< no edge of the input: two triangles cut each other there
  kGivenEdge = 32          ///< of a polyline that the user gave
};

struct FeatureSegment {
  Vec3 a, b;
  Id curve = kNone;
  std::uint8_t kind = 0;  ///< FeatureKind bits
};

/// A polyline; closed ones repeat no point and have no corners.
struct FeatureCurve {
  std::vector<Vec3> points;
  bool closed = false;
  Id startCorner = kNone, endCorner = kNone;  ///< rows of FeatureGraph::corners (a free end is a corner too)
  double length() const;
};

/// Closest point on the curves.
struct ClosestOnFeature {
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity();
  Id segment = kNone;
};

class FeatureGraph {
 public:
  FeatureGraph(std::vector<Vec3> corners, std::vector<FeatureCurve> curves,
               std::vector<FeatureSegment> segments);
  ~FeatureGraph();
  FeatureGraph(FeatureGraph&&) noexcept;
  FeatureGraph& operator=(FeatureGraph&&) noexcept;
  const std::vector<Vec3>& corners() const { return corners_; }
  const std::vector<FeatureCurve>& curves() const { return curves_; }
  /// All curves' segments; a curve's own are consecutive and in its order.
  const std::vector<FeatureSegment>& segments() const { return segments_; }
  /// Closest point on any curve, ties to the smallest segment id; nothing farther than maxDistance.
  /// Thread-safe.
  ClosestOnFeature closest(const Vec3& p, double maxDistance = std::numeric_limits<double>::infinity()) const;
  /// Closest point on one curve.
  ClosestOnFeature closestOnCurve(const Vec3& p, Id curve) const;
  /// Segments whose boxes overlap the box, ascending ids.
  std::vector<Id> segmentsNear(const Box& box) const;

 private:
  struct Index;  // segment lookup
  std::vector<Vec3> corners_;
  std::vector<FeatureCurve> curves_;
  std::vector<FeatureSegment> segments_;
  std::vector<Id> firstSegment_;  // of each curve, and the end
  std::unique_ptr<Index> index_;
};

/// The monitor, if any, hears of the passes from 0 to 1 and can stop them.
FeatureGraph detectFeatures(const SurfaceModel& model, const FeatureOptions& options,
                            Monitor* monitor = nullptr);

}  // namespace pm
