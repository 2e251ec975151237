// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureEdges.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "FeatureNetwork.h"

namespace pm {

namespace {

using Triangle = SurfaceModel::Triangle;

// Coordinates read from text have about six digits: over its opposite edge a point lower than this part of
// the model's diagonal says nothing about where its triangle faces.
constexpr double kTrustedHeight = 8e-6;
constexpr int kLongestSliverChain = 16;

/// One triangle at an edge.
struct Wing {
  Id end;  // the edge's larger point id; the smaller one is the row
  Id triangle;
  Id opposite;  // third point of the triangle
};

/// Triangles of all edges: row = smaller point, wings ascending by (end, triangle).
Csr<Wing> edgeTable(const SurfaceModel& model) {
  const auto& triangles = model.triangles();
  Csr<Wing> table;
  table.offsets.assign(model.points().size() + 2, 0);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++table.offsets[std::min(t[k], t[(k + 1) % 3]) + 2];
  for (std::size_t i = 2; i < table.offsets.size(); ++i) table.offsets[i] += table.offsets[i - 1];
  table.values.resize(3 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    for (int k = 0; k < 3; ++k) {
      const auto [lo, hi] = std::minmax(t[k], t[(k + 1) % 3]);
      table.values[table.offsets[lo + 1]++] = {hi, static_cast<Id>(i), t[(k + 2) % 3]};
    }
  }
  table.offsets.pop_back();
  tbb::parallel_for(Id(0), table.rows(), [&](Id row) {
    std::sort(table.values.begin() + table.offsets[row], table.values.begin() + table.offsets[row + 1],
              [](const Wing& x, const Wing& y) {
                return x.end != y.end ? x.end < y.end : x.triangle < y.triangle;
              });
  });
  return table;
}

Vec3 perpendicular(const Vec3& v, const Vec3& unit) { return v - v.dot(unit) * unit; }

class EdgeClassifier {
 public:
  EdgeClassifier(const SurfaceModel& model, const FeatureOptions& options)
      : model_(model),
        options_(options),
        table_(edgeTable(model)),
        trusted_(kTrustedHeight * model.bounds().diagonal()) {}

  /// Fills the network with sharp edges and interfaces, and lists the open edges.
  void run(FeatureNetwork& network, std::vector<OpenEdge>& open) const {
    std::vector<std::uint8_t> kinds(table_.values.size(), 0);
    tbb::parallel_for(Id(0), table_.rows(), [&](Id row) {
      forEachEdge(
          row, [&](Span<Wing> wings) { kinds[wings.first - table_.values.data()] = classify(row, wings); });
    });
    for (Id row = 0; row < table_.rows(); ++row) {
      forEachEdge(row, [&](Span<Wing> wings) {
        const std::uint8_t kind = kinds[wings.first - table_.values.data()];
        if (kind == kOpenEdge)
          open.push_back({row, wings[0].end, wings[0].triangle});
        else if (kind != 0)
          network.links.push_back({row, wings[0].end, kind});
      });
    }
  }

 private:
  template <class Body>
  void forEachEdge(Id row, const Body& body) const {
    const Span<Wing> wings = table_[row];
    for (const Wing* first = wings.begin(); first != wings.end();) {
      const Wing* last = first;
      while (last != wings.end() && last->end == first->end) ++last;
      body(Span<Wing>{first, last});
      first = last;
    }
  }

  Span<Wing> wingsOf(Id p, Id q) const {
    const auto [lo, hi] = std::minmax(p, q);
    const Span<Wing> row = table_[lo];
    const auto range = std::equal_range(row.begin(), row.end(), Wing{hi, 0, 0},
                                        [](const Wing& x, const Wing& y) { return x.end < y.end; });
    return {range.first, range.second};
  }

  std::uint8_t classify(Id row, Span<Wing> wings) const {
    if (wings.size() == 1) return kOpenEdge;
    std::uint8_t kind = isSharp(row, wings) ? kSharpEdge : 0;
    if (options_.interfaces)
      for (const Wing& w : wings)
        if (model_.patchOf(w.triangle) != model_.patchOf(wings[0].triangle)) kind |= kInterfaceEdge;
    if (kind != 0 && wings.size() > 2) kind |= kNonManifoldEdge;
    return kind;
  }

  /// Looks along the edge at the directions of its wings: it is smooth when they all lie on one line, to
  /// sharpAngle, and on both sides of the edge. That holds for any orientation of the triangles and for
  /// overlapping sheets.
  bool isSharp(Id row, Span<Wing> wings) const {
    const Vec3& a = model_.points()[row];
    const Vec3 along = (model_.points()[wings[0].end] - a).stableNormalized();
    Vec3 first = Vec3::Zero(), across = Vec3::Zero();
    double lowest = 0, highest = 0;
    bool opposed = false;
    int trusted = 0;
    for (const Wing& w : wings) {
      Vec3 side;
      if (!direction(row, w, along, side)) continue;
      if (trusted++ == 0) {
        first = side;
        across = along.cross(first);
        continue;
      }
      double angle = std::atan2(side.dot(across), side.dot(first)) * kDegreesPerRadian;
      if (wings.size() == 2) return 180 - std::abs(angle) > options_.sharpAngle;
      if (std::abs(angle) > 90) {
        opposed = true;
        angle -= std::copysign(180, angle);
      }
      lowest = std::min(lowest, angle);
      highest = std::max(highest, angle);
    }
    return trusted > 1 && (!opposed || highest - lowest > options_.sharpAngle);
  }

  /// Unit direction from the edge into the wing's triangle. A sliver too thin to face anywhere is taken to
  /// lie in the plane of the triangle across its longest edge; false when that cannot be told.
  bool direction(Id row, const Wing& wing, const Vec3& along, Vec3& side) const {
    const Vec3& a = model_.points()[row];
    Id triangle = wing.triangle, opposite = wing.opposite;
    std::pair<Id, Id> from = std::minmax(row, wing.end);
    for (int step = 0; step < kLongestSliverChain; ++step) {
      side = perpendicular(model_.points()[opposite] - a, along);
      const double height = side.stableNorm();
      if (height > trusted_) {
        side /= height;
        return true;
      }
      const std::pair<Id, Id> longest = longestEdge(triangle);
      const Span<Wing> wings = wingsOf(longest.first, longest.second);
      if (longest == from || wings.size() != 2) return false;
      const Wing& next = wings[wings[0].triangle == triangle ? 1 : 0];
      triangle = next.triangle;
      opposite = next.opposite;
      from = longest;
    }
    return false;
  }

  std::pair<Id, Id> longestEdge(Id triangle) const {
    std::pair<Id, Id> best{kNone, kNone};
    double length2 = -1;
    const Triangle& t = model_.triangles()[triangle];
    for (int k = 0; k < 3; ++k) {
      const std::pair<Id, Id> edge = std::minmax(t[k], t[(k + 1) % 3]);
      const double l2 = (model_.points()[edge.second] - model_.points()[edge.first]).squaredNorm();
      if (l2 > length2 || (l2 == length2 && edge < best)) {
        best = edge;
        length2 = l2;
      }
    }
    return best;
  }

  const SurfaceModel& model_;
  const FeatureOptions& options_;
  const Csr<Wing> table_;
  const double trusted_;
};

void checkOptions(const FeatureOptions& options) {
  const auto isAngle = [](double v) { return v >= 0 && v <= 180; };
  const auto isLength = [](double v) { return v >= 0 && std::isfinite(v); };
  if (!isAngle(options.sharpAngle) || !isAngle(options.cornerAngle))
    throw InputError("The sharp angle and the corner angle of features must lie between 0 and 180 degrees.");
  if (!isLength(options.gapTolerance) || !isLength(options.shortestCurve))
    throw InputError("The gap tolerance and the shortest curve of features must be lengths of 0 or more.");
  for (const std::vector<Vec3>& line : options.given)
    for (const Vec3& p : line)
      if (!p.allFinite())
        throw InputError("A feature curve has a point that is not a number; remove that point.");
}

}  // namespace

FeatureGraph detectFeatures(const SurfaceModel& model, const FeatureOptions& options, Monitor* monitor) {
  Monitor unwatched;
  Monitor& watch = monitor != nullptr ? *monitor : unwatched;
  checkOptions(options);
  watch.check(0, "sharp edges");
  FeatureNetwork network;
  network.points = model.points();
  std::vector<OpenEdge> open;
  EdgeClassifier(model, options).run(network, open);
  watch.check(0.1, "open edges");
  open = chooseOpenEdges(model, std::move(open), options);
  const double trusted = kTrustedHeight * model.bounds().diagonal();
  const IntersectionTolerances tolerances{std::max(trusted, options.gapTolerance), trusted};
  addGivenCurves(model, options, tolerances, network, open);
  if (options.intersections) {
    PartMonitor part(watch, 0.2, 0.8);
    addIntersections(model, options, tolerances, network, open, part);
  }
  watch.check(0.8, "welding");
  addOpenEdges(network, open, options.gapTolerance);
  watch.check(0.9, "curves");
  const double reach = std::max(trusted, 4 * options.gapTolerance);
  return traceCurves(network, options, reach);
}

}  // namespace pm
