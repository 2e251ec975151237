// SPDX-License-Identifier: BSD-3-Clause
#include "LayerCheck.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

namespace pm {
namespace {

template <class Body>
void forRanges(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256),
                    [&](const auto& range) { body(range.begin(), range.end()); });
}

template <class Body>
void forEach(std::size_t count, const Body& body) {
  forRanges(count, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

Span<Id> span(const std::vector<Id>& row) { return {row.data(), row.data() + row.size()}; }

}  // namespace

const char* describe(LayerReason reason) {
  static const char* const kWords[kLayerReasons] = {
      "all layers made",
      "no layers wanted",
      "the cell is no prism",
      "the prism is not high enough",
      "a cell would be folded",
      "a face would be degenerate",
      "a face would be too warped",
      "an internal face would be too oblique",
      "a boundary face would be too oblique",
      "a face would be too skew",
      "a neighbour has fewer layers",
  };
  return kWords[static_cast<int>(reason)];
}

LayerCheck::LayerCheck(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
                       const QualityLimits& limits)
    : mesh_(mesh), columns_(columns), points_(points), limits_(limits, mesh.finestSize) {
  centres_.start.assign(1, 0);
  for (Id c = 0; c < columns.count(); ++c)
    centres_.start.push_back(centres_.start.back() + columns.layers(c));
  centres_.ofColumns.resize(centres_.start.back());
  centres_.ofOtherCells.resize(mesh.cellCount);
  seen_.assign(mesh.faceCount(), 0);
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    const Id a = mesh.owner[f], b = mesh.neighbour[f];
    const bool columnA = columns.columnOf(a) != kNone, columnB = columns.columnOf(b) != kNone;
    if (columnA != columnB) beside_.push_back(columnA ? b : a);
  }
  sortUnique(beside_);
  measureBeside();
}

void LayerCheck::measureBeside() {
  forEach(beside_.size(), [&](std::size_t i) { measureBeside(beside_[i]); });
}

void LayerCheck::measureBeside(Id cell) {
  thread_local std::vector<Vec3> centres;
  thread_local std::vector<Id> row, cellPoints;
  thread_local Csr<Id> rows;
  thread_local std::vector<int> signs;
  rows.clear(), centres.clear(), signs.clear(), cellPoints.clear();
  for (Id f : columns_.facesOf(cell))
    for (Id piece = 1; piece <= columns_.pieces(f); ++piece) {
      columns_.pieceRow(f, piece, row);
      rows.push(row);
      signs.push_back(mesh_.owner[f] == cell ? 1 : -1);
      centres.push_back(measureFace(points_, span(row), true).centre);
      cellPoints.insert(cellPoints.end(), row.begin(), row.end());
    }
  sortUnique(cellPoints);
  const CellMeasures m = measureCell(points_, span(cellPoints), [&](const auto& body) {
    for (Id i = 0; i < rows.rows(); ++i) body(rows[i], signs[i], centres[i]);
  });
  centres_.ofOtherCells[cell] = CellCentres(m);
}

LayerReason LayerCheck::capFault(Id column) {
  thread_local std::vector<Id> row;
  const Id cell = columns_.cell(column);
  for (Id level = 1; level < columns_.layers(column); ++level) {
    columns_.capRow(column, level, row);
    const FaceMeasures face = measureFace(points_, span(row));
    if (const LayerFault fault = limits_.ofShape(face, limits_.values().minEtaInternal)) return fault.reason;
    const CellCentres* below = &centres_.at(columns_, cell, level);
    if (const LayerFault fault =
            limits_.ofFace(points_, span(row), face, centres_.at(columns_, cell, level + 1), below))
      return fault.reason;
  }
  return LayerReason::None;
}

LayerReason LayerCheck::faultOf(Id face) {
  thread_local std::vector<Id> row;
  const bool inner = face < mesh_.internalFaces();
  const Id own = mesh_.owner[face], next = inner ? mesh_.neighbour[face] : kNone;
  const Id pieces = columns_.pieces(face);
  for (Id piece = 1; piece <= pieces; ++piece) {
    columns_.pieceRow(face, piece, row);
    const CellCentres* neighbour =
        inner ? &centres_.at(columns_, next, columns_.layerAt(next, face, piece)) : nullptr;
    const CellCentres& owner = centres_.at(columns_, own, columns_.layerAt(own, face, piece));
    if (const LayerFault fault =
            limits_.ofFace(points_, span(row), measureFace(points_, span(row)), owner, neighbour))
      return fault.reason;
  }
  return LayerReason::None;
}

/// A failure where there is only one layer comes of points that columns beside have put on its edges.
void LayerCheck::blame(Id column, LayerReason reason, std::vector<Fault>& faults) const {
  if (columns_.layers(column) > 1) {
    faults.push_back({column, reason});
    return;
  }
  std::vector<Id> near;
  columns_.around(column, near);
  Id most = 1;
  for (Id c : near) most = std::max(most, columns_.layers(c));
  if (most == 1) return;
  for (Id c : near) {
    if (columns_.layers(c) == most) faults.push_back({c, reason});
  }
}

std::vector<Id> LayerCheck::facesAround(const std::vector<Id>& changed) {
  std::vector<Id> faces;
  for (Id column : changed) {
    for (Id f : columns_.facesOf(columns_.cell(column))) {
      if (!seen_[f]) faces.push_back(f);
      seen_[f] = 1;
    }
  }
  for (Id f : faces) seen_[f] = 0;
  return faces;
}

std::vector<LayerCheck::Fault> LayerCheck::columnsToLower(const std::vector<Id>& changed) {
  std::vector<LayerReason> ofColumn(changed.size(), LayerReason::None);
  forRanges(changed.size(), [&](std::size_t first, std::size_t last) {
    LayerTrial own = trial();
    for (std::size_t i = first; i < last; ++i) {
      own.gather({changed[i]});
      ofColumn[i] = own.measureCells();
    }
  });
  forEach(changed.size(), [&](std::size_t i) {
    if (ofColumn[i] == LayerReason::None) ofColumn[i] = capFault(changed[i]);
  });
  const std::vector<Id> faces = facesAround(changed);
  std::vector<LayerReason> ofFace(faces.size());
  forEach(faces.size(), [&](std::size_t i) { ofFace[i] = faultOf(faces[i]); });

  std::vector<Fault> faults;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (ofColumn[i] != LayerReason::None) blame(changed[i], ofColumn[i], faults);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (ofFace[i] == LayerReason::None) continue;
    const Id f = faces[i], own = mesh_.owner[f];
    const Id next = f < mesh_.internalFaces() ? mesh_.neighbour[f] : own;
    const Id most = std::max(columns_.layersOfCell(own), columns_.layersOfCell(next));
    for (Id cell : {own, next}) {
      const Id column = columns_.columnOf(cell);
      if (column != kNone && columns_.layers(column) == most) blame(column, ofFace[i], faults);
    }
  }
  std::sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) {
    return std::tie(a.column, a.reason) < std::tie(b.column, b.reason);
  });
  faults.erase(std::unique(faults.begin(), faults.end(),
                           [](const Fault& a, const Fault& b) { return a.column == b.column; }),
               faults.end());
  return faults;
}

}  // namespace pm
