// SPDX-License-Identifier: BSD-3-Clause
// Are the cells that a choice of layers would give valid? Measures only what a change of layers touches.
#pragma once

#include <vector>

#include "LayerTrial.h"

namespace pm {

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
  /// For measuring a few columns again and again. Trials of different threads must have no column in common
  /// and none beside one of the other's.
  LayerTrial trial() { return LayerTrial(mesh_, columns_, points_, limits_, centres_); }
  /// A cell beside columns that has changed its shape.
  void measureBeside(Id cell);
  /// All of them: layers divide the faces between them and columns, which moves their centres a little.
  void measureBeside();

 private:
  LayerReason capFault(Id column);
  LayerReason faultOf(Id face);
  void blame(Id column, LayerReason reason, std::vector<Fault>& faults) const;
  std::vector<Id> facesAround(const std::vector<Id>& changed);

  const PolyMesh& mesh_;
  const LayerColumns& columns_;
  const std::vector<Vec3>& points_;
  LayerLimits limits_;
  LayerCentres centres_;
  std::vector<Id> beside_;          // cells beside columns
  std::vector<std::uint8_t> seen_;  // #F scratch of facesAround
};

}  // namespace pm
