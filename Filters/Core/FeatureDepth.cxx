// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureDepth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "TriangleBox.h"

namespace pm {
namespace {

// Directions on the unit circle that differ by less are one: overlapping sheets, the common edge of two
// triangles.
constexpr double kSame = 0.05;

constexpr double kDegree = 3.14159265358979323846 / 180;

FeatureGraph detect(const SurfaceModel& model, const OctreeDecomposeOptions& o, double finest,
                    Monitor& monitor) {
  if (!o.refineEdges) return {{}, {}, {}};
  FeatureOptions f;
  f.sharpAngle = o.sharpAngle;
  f.gapTolerance = 0.5 * finest;
  f.openEdges = o.refineOpen == OpenEdgeRefinement::All;
  PartMonitor part(monitor, 0, 0);  // localisation goes on from there
  return detectFeatures(model, f, &part);
}

Box grown(Box box, double by) {
  box.lo.array() -= by;
  box.hi.array() += by;
  return box;
}

/// The part of the segment inside the box; false when there is none.
bool clip(const Box& box, const FeatureSegment& s, Vec3& a, Vec3& b) {
  double t0 = 0, t1 = 1;
  for (int k = 0; k < 3; ++k) {
    const double d = s.b[k] - s.a[k];
    if (d == 0) {
      if (s.a[k] < box.lo[k] || s.a[k] > box.hi[k]) return false;
      continue;
    }
    const double u = (box.lo[k] - s.a[k]) / d, v = (box.hi[k] - s.a[k]) / d;
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
  }
  a = s.a + t0 * (s.b - s.a);
  b = s.a + t1 * (s.b - s.a);
  return t0 <= t1;
}

/// Adds the directions from the centre in which the triangle crosses the circle, each once for all triangles.
void addCrossings(const SurfaceModel& model, Id triangle, const Vec3& centre, const Vec3& axis, double radius,
                  std::vector<Vec3>& directions) {
  std::array<Vec3, 3> p;
  std::array<double, 3> height;
  for (int k = 0; k < 3; ++k) {
    p[k] = model.corner(triangle, k) - centre;
    height[k] = p[k].dot(axis);
  }
  std::array<Vec3, 2> ends;  // of the triangle's cut with the circle's plane
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    if ((height[k] < 0) == (height[l] < 0)) continue;
    const Vec3 at = p[k] + height[k] / (height[k] - height[l]) * (p[l] - p[k]);
    if (count < 2) ends[count++] = at - at.dot(axis) * axis;
  }
  if (count < 2) return;
  const Vec3 d = ends[1] - ends[0];
  const double half = ends[0].dot(d) / d.squaredNorm();
  const double rest = half * half - (ends[0].squaredNorm() - radius * radius) / d.squaredNorm();
  if (!(rest >= 0)) return;
  for (double root : {-std::sqrt(rest), std::sqrt(rest)}) {
    const double t = root - half;
    if (t < 0 || t > 1) continue;
    const Vec3 direction = (ends[0] + t * d) / radius;
    const auto same = [&](const Vec3& v) { return (v - direction).squaredNorm() < kSame * kSame; };
    if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(direction);
  }
}

}  // namespace

FeatureDemand::FeatureDemand(const SurfaceModel& model, const OctreeDecomposeOptions& options, double finest,
                             Monitor& monitor)
    : model_(model), options_(options), finest_(finest), graph_(detect(model, options, finest, monitor)) {
  constexpr std::uint8_t kSwitched = kInterfaceEdge | kOpenEdge | kNonManifoldEdge;
  if (options.refineSharp) kinds_ = static_cast<std::uint8_t>(~kSwitched);
  if (options.refineInterfaces) kinds_ |= kInterfaceEdge;
  if (options.refineOpen != OpenEdgeRefinement::None) kinds_ |= kOpenEdge;
  for (const FeatureCurve& curve : graph_.curves()) length_.push_back(curve.length());
  if (!options.refineCorners) return;
  std::vector<std::uint8_t> met(graph_.corners().size(), 0);
  for (const FeatureSegment& s : graph_.segments())
    if (counts(s))
      for (Id corner : {graph_.curves()[s.curve].startCorner, graph_.curves()[s.curve].endCorner})
        if (corner != kNone && (graph_.corners()[corner] == s.a || graph_.corners()[corner] == s.b))
          met[corner] = 1;
  for (Id c = 0; c < static_cast<Id>(met.size()); ++c)
    if (!met[c]) loneCorners_.push_back(c);
}

FeatureDemand::Demand FeatureDemand::at(const Box& cell) const {
  if (graph_.segments().empty()) return {};
  if (options_.featureDepth == FeatureDepth::AsNeeded) return asNeeded(cell);
  return {fullDepth(cell), 1};
}

// Within featureBuffer finest cells of the cell, so that the front has fine cells to either side of the
// feature's own.
FeatureDemand::Answer FeatureDemand::fullDepth(const Box& cell) const {
  const Box reach = grown(cell, options_.featureBuffer * finest_);
  bool near = false;
  for (Id s : graph_.segmentsNear(reach)) {
    const FeatureSegment& segment = graph_.segments()[s];
    if (!counts(segment) || !touches(reach, segment.a, segment.b)) continue;
    if (touches(cell, segment.a, segment.b)) return Answer::Split;
    near = true;
  }
  for (Id c : loneCorners_) {
    if (cell.contains(graph_.corners()[c])) return Answer::Split;
    near = near || reach.contains(graph_.corners()[c]);
  }
  return near ? Answer::Near : Answer::None;
}

std::vector<Id> FeatureDemand::curvesNear(const Box& cell, double longest) const {
  const Box reach = grown(cell, std::max(cell.size().maxCoeff(), options_.featureBuffer * finest_));
  std::vector<Id> curves;
  for (Id s : graph_.segmentsNear(reach)) {
    const FeatureSegment& segment = graph_.segments()[s];
    if (!curves.empty() && curves.back() == segment.curve) continue;
    if (length_[segment.curve] <= longest && counts(segment) && touches(reach, segment.a, segment.b))
      curves.push_back(segment.curve);
  }
  return curves;
}

/// Consecutive segments of one curve, in its order; a closed curve's run may go on over its end.
struct FeatureDemand::Run {
  Id curve = kNone;
  std::vector<Id> segments;
  bool inside = false;  ///< touches the cell itself
};

std::vector<FeatureDemand::Run> FeatureDemand::runsNear(const Box& around, const Box& cell) const {
  std::vector<Run> runs;
  const std::vector<FeatureSegment>& all = graph_.segments();
  std::size_t firstOfCurve = 0;
  const auto joinEnds = [&] {  // of a closed curve whose seam lies in the box
    if (runs.size() < firstOfCurve + 2 || !graph_.curves()[runs.back().curve].closed) return;
    Run &head = runs[firstOfCurve], &tail = runs.back();
    if (all[head.segments.front()].a != all[tail.segments.back()].b) return;
    tail.segments.insert(tail.segments.end(), head.segments.begin(), head.segments.end());
    tail.inside = tail.inside || head.inside;
    head = std::move(tail);
    runs.pop_back();
  };
  for (Id s : graph_.segmentsNear(around)) {
    if (!counts(all[s]) || !touches(around, all[s].a, all[s].b)) continue;
    if (runs.empty() || runs.back().curve != all[s].curve) {
      joinEnds();
      firstOfCurve = runs.size();
      runs.push_back({all[s].curve, {}, false});
    } else if (runs.back().segments.back() + 1 != s) {
      runs.push_back({all[s].curve, {}, false});
    }
    runs.back().segments.push_back(s);
    runs.back().inside = runs.back().inside || touches(cell, all[s].a, all[s].b);
  }
  joinEnds();
  return runs;
}

FeatureDemand::Demand FeatureDemand::asNeeded(const Box& leaf) const {
  // What lies on a cell's side lies in it, however scale and offset round it.
  constexpr double kTouch = 1e-6;
  const Box cell = grown(leaf, kTouch * finest_);
  const Box around = grown(cell, std::max(leaf.size().maxCoeff(), options_.featureBuffer * finest_));
  const std::vector<Run> runs = runsNear(around, cell);
  std::vector<Id> corners;
  const auto addCorner = [&](Id c) {
    if (c != kNone && around.contains(graph_.corners()[c])) corners.push_back(c);
  };
  for (Id c : loneCorners_) addCorner(c);
  int inside = 0;
  for (const Run& run : runs) {
    addCorner(graph_.curves()[run.curve].startCorner);
    addCorner(graph_.curves()[run.curve].endCorner);
    inside += run.inside;
  }
  sortUnique(corners);
  const bool corner = !corners.empty() && cell.contains(graph_.corners()[corners[0]]);
  if (inside == 0 && !corner && !isNear(cell, runs)) return {};

  bool split = corners.size() > 1 || (corners.empty() && runs.size() > 1);
  for (const Run& run : runs) {
    const Vec3 &a = graph_.segments()[run.segments.front()].a, &b = graph_.segments()[run.segments.back()].b;
    const bool joined =
        corners.empty() || a == graph_.corners()[corners[0]] || b == graph_.corners()[corners[0]];
    split = split || !joined || turns(run) || sags(cell, run) ||
            looksBluntOrAcute(run.inside ? cell : around, run, leaf.size().maxCoeff());
  }
  if (inside == 0 && !corner) return {split ? Answer::Near : Answer::None, 1};
  return {split ? Answer::Split : Answer::Keep, corner ? std::max(inside, 1) : inside + 1};
}

bool FeatureDemand::isNear(const Box& cell, const std::vector<Run>& runs) const {
  const Box reach = grown(cell, options_.featureBuffer * finest_);
  for (const Run& run : runs)
    for (Id s : run.segments)
      if (touches(reach, graph_.segments()[s].a, graph_.segments()[s].b)) return true;
  return false;
}

/// Compares the directions of the run's segments with that of its first one.
bool FeatureDemand::turns(const Run& run) const {
  const auto along = [&](Id s) {
    return (graph_.segments()[s].b - graph_.segments()[s].a).stableNormalized();
  };
  const Vec3 first = along(run.segments.front());
  return std::any_of(run.segments.begin(), run.segments.end(),
                     [&](Id s) { return along(s).dot(first) < std::cos(kMostTurn * kDegree); });
}

/// Distance of the run's points in the cell from the chord between its two ends there.
bool FeatureDemand::sags(const Box& cell, const Run& run) const {
  std::vector<Vec3> piece;
  for (Id s : run.segments) {
    Vec3 a, b;
    if (!clip(cell, graph_.segments()[s], a, b)) continue;
    piece.push_back(a);
    piece.push_back(b);
  }
  if (piece.size() < 4) return false;
  const Vec3 start = piece.front(), chord = (piece.back() - start).stableNormalized();
  return std::any_of(piece.begin(), piece.end(), [&](const Vec3& p) {
    const Vec3 off = p - start;
    return (off - off.dot(chord) * chord).norm() > kMostSag * finest_;
  });
}

/// Where the surface crosses a circle around a point of the run in the box, square to the curve and a cell's
/// edge wide, are the far sides of the faces beside the edge. An edge between two surfaces is crossed twice.
bool FeatureDemand::looksBluntOrAcute(const Box& part, const Run& run, double radius) const {
  const std::vector<FeatureSegment>& all = graph_.segments();
  std::vector<Id> within;
  for (Id s : run.segments)
    if (touches(part, all[s].a, all[s].b)) within.push_back(s);
  if (within.empty()) return false;
  const FeatureSegment& segment = all[within[within.size() / 2]];
  Vec3 a, b;
  if ((segment.kind & kSharpEdge) == 0 || !clip(part, segment, a, b)) return false;
  const Vec3 middle = 0.5 * (a + b), along = (segment.b - segment.a).stableNormalized();
  Box reach;
  reach.add(middle);
  std::vector<Vec3> met;
  for (Id t : model_.trianglesNear(grown(reach, radius))) addCrossings(model_, t, middle, along, radius, met);
  if (met.size() != 2) return false;
  const double cosine = met[0].dot(met[1]);  // of the angle between the sides
  return cosine < -std::cos(kLeastShare * options_.sharpAngle * kDegree) ||
         (options_.separate && cosine > std::cos(options_.closeAngle * kDegree));
}

}  // namespace pm
