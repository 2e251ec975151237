// SPDX-License-Identifier: BSD-3-Clause
#include "LayerLimits.h"

#include <cmath>

namespace pm {
namespace {

constexpr double kDegree = M_PI / 180;

/// Cosine of the angle between two vectors; -1 when either has no length.
double cosine(const Vec3& a, const Vec3& b) {
  const double lengths = std::sqrt(a.squaredNorm() * b.squaredNorm());
  return lengths > 0 ? a.dot(b) / lengths : -1;
}

/// Not above a largest angle, given by its cosine.
LayerFault ofCosine(double value, double least, LayerReason reason) {
  if (value >= least) return {};
  return {reason, (least - value) / (1 + least)};
}

LayerFault ofSkewness(double value, double most) {
  if (value <= most) return {};
  return {LayerReason::Skewness, 1 - most / value};
}

}  // namespace

LayerLimits::LayerLimits(const QualityLimits& limits, double unit)
    : limits_(limits),
      cosInternal_(std::cos(limits.maxAngleInternal * kDegree)),
      cosBoundary_(std::cos(limits.maxAngleBoundary * kDegree)),
      cosWarpage_(std::cos(limits.maxWarpage * kDegree)),
      minTet_(limits.minTet * unit * unit * unit) {}

LayerFault LayerLimits::ofWarpage(const FaceMeasures& face) const {
  return ofCosine(face.cosWarpage, cosWarpage_, LayerReason::Warpage);
}

LayerFault LayerLimits::ofCentres(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                                  const CellCentres& owner, const CellCentres* neighbour) const {
  if (neighbour == nullptr) {
    const double angle = cosine(face.normal, face.centre - owner.thesis);
    if (const LayerFault fault = ofCosine(angle, cosBoundary_, LayerReason::AngleBoundary)) return fault;
    return ofSkewness(boundarySkewness(points, row, face, owner.foam), limits_.maxSkewBoundary);
  }
  const double angle = std::min(cosine(face.normal, neighbour->thesis - owner.thesis),
                                cosine(face.normal, neighbour->foam - owner.foam));
  if (const LayerFault fault = ofCosine(angle, cosInternal_, LayerReason::AngleInternal)) return fault;
  return ofSkewness(internalSkewness(points, row, face, owner.foam, neighbour->foam),
                    limits_.maxSkewInternal);
}

LayerFault LayerLimits::ofFace(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                               const CellCentres& owner, const CellCentres* neighbour) const {
  if (const LayerFault fault = ofWarpage(face)) return fault;
  return ofCentres(points, row, face, owner, neighbour);
}

LayerFault LayerLimits::ofShape(const FaceMeasures& face, double minEta) const {
  if (face.eta >= minEta) return {};
  return {LayerReason::FaceShape, std::isfinite(face.eta) ? std::min(1.0, 1 - face.eta / minEta) : 1};
}

LayerFault LayerLimits::ofCell(const CellMeasures& cell) const {
  // A hair above zero, so that rounding in another program does not find it negative.
  const double least = std::max(minTet_, 1e-6 * cell.volume);
  const double worst = std::min(cell.minTet, cell.minPyramid);
  if (cell.volume > 0 && worst > least) return {};
  const bool inverted = !(cell.volume > 0) || !std::isfinite(worst);
  return {LayerReason::FoldedCell, inverted ? 1 : (least - worst) / (least - worst + cell.volume)};
}

}  // namespace pm
