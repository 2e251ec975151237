// SPDX-License-Identifier: BSD-3-Clause
// What the cells and faces of layers must keep: all limits but minVolume and the degradation of side faces,
// which are small in layers on purpose.
#pragma once

#include "LayerReason.h"
#include "MeshQuality.h"

namespace pm {

/// A cell's centre as eq 4-17 has it, for angles, and as OpenFOAM has it, for skewness.
struct CellCentres {
  CellCentres() = default;
  explicit CellCentres(const CellMeasures& m) : thesis(m.centre), foam(m.foamCentre) {}
  Vec3 thesis = Vec3::Zero(), foam = Vec3::Zero();
};

/// A limit that is broken, and how far beyond it the measure is: 0 at the limit, 1 at the worst there is.
struct LayerFault {
  LayerReason reason = LayerReason::None;
  double excess = 0;
  explicit operator bool() const { return reason != LayerReason::None; }
  double cost() const { return *this ? 1 + excess : 0; }
};

class LayerLimits {
 public:
  /// unit: the mesh's finestSize.
  LayerLimits(const QualityLimits& limits, double unit);

  LayerFault ofWarpage(const FaceMeasures& face) const;
  /// Angle and skewness of a face. neighbour: null on the boundary.
  LayerFault ofCentres(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                       const CellCentres& owner, const CellCentres* neighbour) const;
  /// All three.
  LayerFault ofFace(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                    const CellCentres& owner, const CellCentres* neighbour) const;
  /// Degradation, which a face between two layers must keep.
  LayerFault ofShape(const FaceMeasures& face, double minEta) const;
  /// Are all central tetrahedra and face pyramids of a cell above the limit?
  LayerFault ofCell(const CellMeasures& cell) const;
  const QualityLimits& values() const { return limits_; }

 private:
  QualityLimits limits_;
  double cosInternal_, cosBoundary_, cosWarpage_, minTet_;
};

}  // namespace pm
