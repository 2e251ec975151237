// SPDX-License-Identifier: BSD-3-Clause
// Feature edges before they are curves: a graph of points and links, and the passes that make and consume it.
// Internal to feature detection (FeatureEdges.h).
#pragma once

#include <cmath>

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
  std::vector<Vec3> points;  // the model's, by the same ids; welding moves some
  std::vector<Link> links;   // each pair of points once, ascending
};

/// An edge of one triangle only.
struct OpenEdge {
  Id a, b;  // a < b
  Id triangle;
};

/// Which open edges are features: all on request, else those near geometry they ought to be stitched to.
std::vector<OpenEdge> chooseOpenEdges(const SurfaceModel& model, std::vector<OpenEdge> open,
                                      const FeatureOptions& options);

/// Adds open edges to the network. Borders within the tolerance of each other or of links already there are
/// welded into one line: points join points, then points split the links they lie on, then equal links are
/// one.
void addOpenEdges(FeatureNetwork& network, const std::vector<OpenEdge>& open, double tolerance);

/// Joins links into curves between corners. Turning is measured over at least `reach` on both sides of a
/// point, so that the rounding of nearly coincident points makes no corners.
FeatureGraph traceCurves(const FeatureNetwork& network, const FeatureOptions& options, double reach);

}  // namespace pm
