// SPDX-License-Identifier: BSD-3-Clause
#include "LayerTrial.h"

#include <algorithm>
#include <numeric>

namespace pm {

void LayerTrial::gather(const std::vector<Id>& columns, Id moves) {
  gathered_ = columns;
  firstSlot_.assign(1, 0);
  cellCentres_.clear();
  rows_.clear();
  pieces_.clear();
  measured_ = false;
  for (Id column : columns) {
    const Id layers = columns_.layers(column);
    firstSlot_.push_back(firstSlot_.back() + layers);
    for (Id layer = 1; layer <= layers; ++layer)
      cellCentres_.push_back(&centres_.at(columns_, columns_.cell(column), layer));
  }
  for (Id column : columns) {
    const Id cell = columns_.cell(column);
    for (Id f : columns_.facesOf(cell)) {
      const bool isOwner = mesh_.owner[f] == cell;
      if (isOwner || slot(mesh_.owner[f], 1) == kNone) addFace(f);  // else with the owner
    }
    addCaps(column);
  }
  if (moves != kNone) markMoving(moves);
  listCells();
}

/// Number among the gathered cells.
Id LayerTrial::slot(Id cell, Id layer) const {
  const Id column = columns_.columnOf(cell);
  const auto at = std::find(gathered_.begin(), gathered_.end(), column);
  return column == kNone || at == gathered_.end() ? kNone : firstSlot_[at - gathered_.begin()] + layer - 1;
}

/// A face with the points in row_. nextCell: kNone on the boundary.
void LayerTrial::addPiece(Id ownCell, Id ownLayer, Id nextCell, Id nextLayer) {
  Piece piece;
  piece.cells[0] = slot(ownCell, ownLayer);
  piece.centres[0] = &centres_.at(columns_, ownCell, ownLayer);
  if (nextCell != kNone) {
    piece.cells[1] = slot(nextCell, nextLayer);
    piece.centres[1] = &centres_.at(columns_, nextCell, nextLayer);
  }
  rows_.push(row_);
  pieces_.push_back(piece);
}

void LayerTrial::addFace(Id face) {
  const Id own = mesh_.owner[face], count = columns_.pieces(face);
  const Id next = face < mesh_.internalFaces() ? mesh_.neighbour[face] : kNone;
  for (Id piece = 1; piece <= count; ++piece) {
    columns_.pieceRow(face, piece, row_);
    addPiece(own, columns_.layerAt(own, face, piece), next,
             next == kNone ? 0 : columns_.layerAt(next, face, piece));
  }
}

void LayerTrial::addCaps(Id column) {
  const Id cell = columns_.cell(column);
  for (Id level = 1; level < columns_.layers(column); ++level) {
    columns_.capRow(column, level, row_);
    addPiece(cell, level + 1, cell, level);
    pieces_.back().isCap = true;
  }
}

void LayerTrial::markMoving(Id lower) {
  const Id first = columns_.firstPoint(lower), end = first + columns_.edgeLayers(lower) - 1;
  for (Id i = 0; i < rows_.rows(); ++i) {
    const Span<Id> row = rows_[i];
    pieces_[i].moves =
        std::any_of(row.begin(), row.end(), [&](Id p) { return p == lower || (p >= first && p < end); });
  }
}

/// Pieces and points of each cell.
void LayerTrial::listCells() {
  const Id cells = firstSlot_.back();
  std::vector<Id>& start = cellPieces_.offsets;
  start.assign(cells + 1, 0);
  for (const Piece& piece : pieces_)
    for (Id cell : piece.cells)
      if (cell != kNone) ++start[cell + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  cellPieces_.values.resize(start.back());
  row_.assign(start.begin(), start.end() - 1);  // where the next of each cell goes
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    for (Id cell : pieces_[i].cells)
      if (cell != kNone) cellPieces_.values[row_[cell]++] = static_cast<Id>(i);
  cellPoints_.clear();
  for (Id cell = 0; cell < cells; ++cell) {
    row_.clear();
    for (Id i : cellPieces_[cell]) row_.insert(row_.end(), rows_[i].begin(), rows_[i].end());
    sortUnique(row_);
    cellPoints_.push(row_);
  }
}

void LayerTrial::measureFaces(bool onlyCentres) {
  faces_.resize(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    if (!measured_ || pieces_[i].moves)
      faces_[i] = measureFace(points_, rows_[static_cast<Id>(i)], onlyCentres);
  measured_ = !onlyCentres;
}

LayerFault LayerTrial::measureCell(Id slot) {
  const CellMeasures m = pm::measureCell(points_, cellPoints_[slot], [&](const auto& body) {
    for (Id i : cellPieces_[slot]) body(rows_[i], pieces_[i].cells[0] == slot ? 1 : -1, faces_[i].centre);
  });
  *cellCentres_[slot] = CellCentres(m);
  return limits_.ofCell(m);
}

LayerReason LayerTrial::measureCells() {
  measureFaces(true);
  LayerReason reason = LayerReason::None;
  for (Id cell = 0; cell < firstSlot_.back(); ++cell) {
    const LayerFault fault = measureCell(cell);
    if (reason == LayerReason::None) reason = fault.reason;
  }
  return reason;
}

double LayerTrial::cost(double enough) {
  measureFaces(false);
  // What costs least to know comes first: it often is enough.
  double sum = 0;
  for (std::size_t i = 0; i < pieces_.size() && sum < enough; ++i) {
    sum += limits_.ofWarpage(faces_[i]).cost();
    if (pieces_[i].isCap) sum += limits_.ofShape(faces_[i], limits_.values().minEtaInternal).cost();
  }
  for (Id cell = 0; cell < firstSlot_.back() && sum < enough; ++cell) sum += measureCell(cell).cost();
  for (std::size_t i = 0; i < pieces_.size() && sum < enough; ++i) {
    const auto& [owner, neighbour] = pieces_[i].centres;
    sum += limits_.ofCentres(points_, rows_[static_cast<Id>(i)], faces_[i], *owner, neighbour).cost();
  }
  return sum;
}

}  // namespace pm
