// SPDX-License-Identifier: BSD-3-Clause
// The cells and faces that the layers of a few columns side by side have: gathered once, measured again for
// every shape that a search tries.
//
// Only faces with points of the edge that changes its shape are measured again, and a shape is given up as
// soon as it is known to be no better than the best so far.
#pragma once

#include <limits>
#include <vector>

#include "LayerColumns.h"
#include "LayerLimits.h"

namespace pm {

/// Centres of the cells that layers would make, and of the other cells beside columns.
struct LayerCentres {
  std::vector<Id> start;                  ///< of each column's layers in ofColumns
  std::vector<CellCentres> ofColumns;     ///< of each column the layers from the wall
  std::vector<CellCentres> ofOtherCells;  ///< #C, set for cells beside columns

  CellCentres& at(const LayerColumns& columns, Id cell, Id layer) {
    const Id column = columns.columnOf(cell);
    return column == kNone ? ofOtherCells[cell] : ofColumns[start[column] + layer - 1];
  }
};

class LayerTrial {
 public:
  /// All arguments must outlive this. points: the mesh's and behind them those between layers.
  LayerTrial(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
             const LayerLimits& limits, LayerCentres& centres)
      : mesh_(mesh), columns_(columns), points_(points), limits_(limits), centres_(centres) {}

  /// Takes these columns, different ones; to be called again after a change of their layers or of what is
  /// pinched. moves: the lower end of the edge whose points alone will move; kNone: any may.
  void gather(const std::vector<Id>& columns, Id moves = kNone);
  /// Measures the cells and brings their centres up to date; what the first that breaks a limit breaks.
  LayerReason measureCells();
  /// Measures cells and faces: for each that breaks a limit 1 and its excess, in sum. Stops where the sum
  /// reaches `enough`; then not all centres are up to date.
  double cost(double enough = std::numeric_limits<double>::infinity());

 private:
  struct Piece {
    bool moves = true, isCap = false;
    Id cells[2] = {kNone, kNone};                        // of those gathered: owner and neighbour
    const CellCentres* centres[2] = {nullptr, nullptr};  // the neighbour's is null on the boundary
  };

  void addPiece(Id ownCell, Id ownLayer, Id nextCell, Id nextLayer);
  void addFace(Id face);
  void addCaps(Id column);
  void markMoving(Id lower);
  void listCells();
  Id slot(Id cell, Id layer) const;
  void measureFaces(bool onlyCentres);
  LayerFault measureCell(Id slot);

  const PolyMesh& mesh_;
  const LayerColumns& columns_;
  const std::vector<Vec3>& points_;
  const LayerLimits& limits_;
  LayerCentres& centres_;
  std::vector<Id> gathered_, firstSlot_;  // the columns, and where the cells of each start
  Csr<Id> rows_;                          // of each piece: its points
  std::vector<Piece> pieces_;
  std::vector<FaceMeasures> faces_;  // of each piece
  Csr<Id> cellPieces_, cellPoints_;  // of each cell
  std::vector<CellCentres*> cellCentres_;
  std::vector<Id> row_;  // scratch
  bool measured_ = false;
};

}  // namespace pm
