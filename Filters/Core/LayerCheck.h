// SPDX-License-Identifier: BSD-3-Clause
// Are the cells that a choice of layers would give valid? Measures only what a change of layers touches.
#pragma once

#include <vector>

#include "LayerColumns.h"
#include "LayerReason.h"
#include "MeshQuality.h"

namespace pm {

/// A cell's centre as eq 4-17 has it, for angles, and as OpenFOAM has it, for skewness.
struct CellCentres {
  CellCentres() = default;
  explicit CellCentres(const CellMeasures& m) : thesis(m.centre), foam(m.foamCentre) {}
  Vec3 thesis = Vec3::Zero(), foam = Vec3::Zero();
};

/// What warpage, angles and skewness of a face break, None when they are within the limits. neighbour: null
/// on the boundary.
LayerReason faceFault(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                      const CellCentres& owner, const CellCentres* neighbour, const QualityLimits& limits);
/// Are all central tetrahedra and face pyramids of a cell above the limit? unit: finest size.
bool cellHolds(const CellMeasures& cell, const QualityLimits& limits, double unit);

class LayerCheck {
 public:
  /// points: the mesh's and, after them, the points on the edges. Columns may not get more layers than they
  /// have now. The limits hold but for minVolume, and eta of side faces: both are small in layers on purpose.
  LayerCheck(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
             const QualityLimits& limits);

  struct Fault {
    Id column = kNone;
    LayerReason reason = LayerReason::None;
  };
  /// Measures the cells of the columns and the faces around them; returns the columns that must lose a layer
  /// for the failures among these, ascending, each once. Failures that no column's layers cause are not
  /// counted.
  std::vector<Fault> columnsToLower(const std::vector<Id>& changed);
  /// The same, but says only how many of the cells and faces fail. Thread-safe for columns that have no cell
  /// in common and none beside one of the other's.
  int countFaults(const std::vector<Id>& columns);
  /// A cell beside columns that has changed its shape.
  void measureBeside(Id cell);

 private:
  bool measureColumn(Id column);
  LayerReason capFault(Id column) const;
  LayerReason faultOf(Id face) const;
  const CellCentres& centre(Id cell, Id layer) const;
  void blame(Id column, LayerReason reason, std::vector<Fault>& faults) const;
  std::vector<Id> facesAround(const std::vector<Id>& changed);

  const PolyMesh& mesh_;
  const LayerColumns& columns_;
  const std::vector<Vec3>& points_;
  QualityLimits limits_;
  std::vector<Id> centreStart_;  // of each column's layers in centres_
  std::vector<CellCentres> centres_;
  std::vector<CellCentres> otherCentres_;  // #C, set for cells beside columns
  std::vector<std::uint8_t> seen_;         // #F scratch of facesAround
};

}  // namespace pm
