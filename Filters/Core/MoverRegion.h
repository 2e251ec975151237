// SPDX-License-Identifier: BSD-3-Clause
// What moves of some points can touch, numbered on its own: the part of a mesh that NodeMover keeps measures
// of. Everything else of the mesh, often most of it, costs four bytes.
#pragma once

#include "PolyMesh.h"

namespace pm {

/// Slots ascend with the mesh's ids; rows hold the mesh's ids, ascending. Cells of movable points come first;
/// behind them the rim, cells that only share a face with one of those: moves look at them, and leave them as
/// they are.
struct MoverRegion {
  /// movable: the points that may move; null for all of them.
  MoverRegion(const PolyMesh& mesh, const std::vector<Id>* movable);
  /// Boundary faces have been cut or merged (see WallCuts); points, cells and internal faces are as before.
  void renewBoundary(const PolyMesh& mesh);

  std::vector<Id> pointSlot;       // #P of a movable point, else kNone
  std::vector<Id> faceSlot;        // #F of a face of a cell of theirs, else kNone
  std::vector<Id> cellSlot;        // #C of a cell of theirs or of the rim, else kNone
  Id points = 0, faces = 0;        // number of slots
  Id cells = 0, cellsAndRim = 0;   // slots of cells; with those of the rim behind them
  Csr<Id> pointCells, pointFaces;  // #points
  Csr<Id> cellFaces, cellPoints;   // #cells
  bool isRim(Id cell) const { return cellSlot[cell] >= cells; }
  bool isInner(Id cell) const { return cellSlot[cell] != kNone && !isRim(cell); }  ///< of a movable point
};

/// The faces of the cells with slots in [first, last).
Csr<Id> facesOfSlots(const PolyMesh& mesh, const std::vector<Id>& cellSlot, Id first, Id last);

/// Different points of each row's faces, ascending.
Csr<Id> pointsOfRows(const PolyMesh& mesh, const Csr<Id>& faceRows);

/// Points that are not marked but share a cell with one that is, ascending; marks them.
std::vector<Id> nextRing(const PolyMesh& mesh, std::vector<std::uint8_t>& marked);
/// Wall points and the bases below them, then as many rings of points around them as asked for.
std::vector<Id> pointsNearWall(const PolyMesh& mesh, int rings);

}  // namespace pm
