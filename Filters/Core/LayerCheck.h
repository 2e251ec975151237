// SPDX-License-Identifier: BSD-3-Clause
// Are the cells that a choice of layers would give valid? Measures only what a change of layers touches.
#pragma once

#include <vector>

#include "LayerColumns.h"
#include "MeshQuality.h"

namespace pm {

class LayerCheck {
 public:
  /// points: the mesh's and, after them, the points on the edges. Columns may only lose layers while the
  /// check lives. The limits hold but for minVolume, and eta of side faces: both are small in layers on
  /// purpose.
  LayerCheck(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
             const QualityLimits& limits);

  /// Measures the cells of the columns and the faces around them; returns the columns that must lose a layer
  /// for the failures among these, ascending. Failures that no column's layers cause are not counted.
  std::vector<Id> columnsToLower(const std::vector<Id>& changed);

 private:
  bool measureColumn(Id column);
  bool capsHold(Id column) const;
  bool faceHolds(Id face) const;
  /// A cell's centre as eq 4-17 has it, for angles, and as OpenFOAM has it, for skewness.
  struct CellCentres {
    CellCentres() = default;
    explicit CellCentres(const CellMeasures& m) : thesis(m.centre), foam(m.foamCentre) {}
    Vec3 thesis = Vec3::Zero(), foam = Vec3::Zero();
  };
  bool holds(const std::vector<Id>& row, const FaceMeasures& face, const CellCentres& owner,
             const CellCentres* neighbour) const;
  const CellCentres& centre(Id cell, Id layer) const;
  void lowerAround(Id column, std::vector<Id>& lower) const;
  std::vector<Id> facesAround(const std::vector<Id>& changed);

  const PolyMesh& mesh_;
  const LayerColumns& columns_;
  const std::vector<Vec3>& points_;
  QualityLimits limits_;
  double minTet_;
  std::vector<Id> centreStart_;  // of each column's layers in centres_
  std::vector<CellCentres> centres_;
  std::vector<CellCentres> otherCentres_;  // #C, set for cells beside columns
  std::vector<std::uint8_t> seen_;         // #F scratch of facesAround
};

}  // namespace pm
