// SPDX-License-Identifier: BSD-3-Clause
#include "LayerCheck.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace pm {
namespace {

template <class Body>
void forEach(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

Span<Id> span(const std::vector<Id>& row) { return {row.data(), row.data() + row.size()}; }

void sortUnique(std::vector<Id>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

/// The faces of one cell, kept between cells so that nothing is allocated in the loop.
struct CellFaces {
  Csr<Id> rows;
  std::vector<int> signs;
  std::vector<Vec3> centres;
  std::vector<Id> row, points;

  void clear() {
    rows.clear();
    signs.clear();
  }
  void add(int sign) {
    rows.push(row);
    signs.push_back(sign);
  }
  CellMeasures measure(const std::vector<Vec3>& all) {
    centres.clear();
    for (Id i = 0; i < rows.rows(); ++i) centres.push_back(measureFace(all, rows[i], true).centre);
    points = rows.values;
    sortUnique(points);
    return measureCell(all, span(points), [&](const auto& body) {
      for (Id i = 0; i < rows.rows(); ++i) body(rows[i], signs[i], centres[i]);
    });
  }
};

}  // namespace

LayerCheck::LayerCheck(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
                       const QualityLimits& limits)
    : mesh_(mesh), columns_(columns), points_(points), limits_(limits) {
  const double unit = mesh.finestSize * mesh.finestSize * mesh.finestSize;
  minTet_ = limits.minTet * unit;
  centreStart_.assign(1, 0);
  for (Id c = 0; c < columns.count(); ++c) centreStart_.push_back(centreStart_.back() + columns.layers(c));
  centres_.resize(centreStart_.back());
  seen_.assign(mesh.faceCount(), 0);
  otherCentres_.resize(mesh.cellCount);
  std::vector<Id> beside;
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    const Id a = mesh.owner[f], b = mesh.neighbour[f];
    const bool columnA = columns.columnOf(a) != kNone, columnB = columns.columnOf(b) != kNone;
    if (columnA != columnB) beside.push_back(columnA ? b : a);
  }
  sortUnique(beside);
  forEach(beside.size(), [&](std::size_t i) {
    thread_local CellFaces faces;
    faces.clear();
    for (Id f : columns.facesOf(beside[i])) {
      faces.row.assign(mesh.faces[f].begin(), mesh.faces[f].end());
      faces.add(mesh.owner[f] == beside[i] ? 1 : -1);
    }
    otherCentres_[beside[i]] = CellCentres(faces.measure(points));
  });
}

const LayerCheck::CellCentres& LayerCheck::centre(Id cell, Id layer) const {
  const Id column = columns_.columnOf(cell);
  return column == kNone ? otherCentres_[cell] : centres_[centreStart_[column] + layer - 1];
}

/// Centres of the column's cells; false when a central tetrahedron is too small.
bool LayerCheck::measureColumn(Id column) {
  thread_local CellFaces faces;
  const Id cell = columns_.cell(column), layers = columns_.layers(column);
  bool good = true;
  for (Id layer = 1; layer <= layers; ++layer) {
    faces.clear();
    for (Id f : columns_.facesOf(cell)) {
      const Id pieces = columns_.pieces(f);
      for (Id piece = 1; piece <= pieces; ++piece) {
        if (columns_.layerAt(cell, f, piece) != layer) continue;
        columns_.pieceRow(f, piece, faces.row);
        faces.add(mesh_.owner[f] == cell ? 1 : -1);
      }
    }
    for (Id level : {layer - 1, layer}) {
      if (level == 0 || level == layers) continue;
      for (Id part = 0; part < columns_.capParts(column); ++part) {
        columns_.capRow(column, level, part, faces.row);
        faces.add(level < layer ? 1 : -1);
      }
    }
    const CellMeasures m = faces.measure(points_);
    centres_[centreStart_[column] + layer - 1] = CellCentres(m);
    // A hair above zero, so that rounding in another program does not find it negative.
    good = good && m.volume > 0 && std::min(m.minTet, m.minPyramid) > std::max(minTet_, 1e-6 * m.volume);
  }
  return good;
}

bool LayerCheck::holds(const std::vector<Id>& row, const FaceMeasures& face, const CellCentres& owner,
                       const CellCentres* neighbour) const {
  const bool inner = neighbour != nullptr;
  const Vec3 direction = (inner ? neighbour->thesis : face.centre) - owner.thesis;
  if (inner && faceAngle(face.normal, neighbour->foam - owner.foam) > limits_.maxAngleInternal) return false;
  const double skew = inner ? internalSkewness(points_, span(row), face, owner.foam, neighbour->foam)
                            : boundarySkewness(points_, span(row), face, owner.foam);
  return face.warpage() <= limits_.maxWarpage &&
         faceAngle(face.normal, direction) <= (inner ? limits_.maxAngleInternal : limits_.maxAngleBoundary) &&
         skew <= (inner ? limits_.maxSkewInternal : limits_.maxSkewBoundary);
}

bool LayerCheck::capsHold(Id column) const {
  thread_local std::vector<Id> row;
  const Id cell = columns_.cell(column);
  for (Id level = 1; level < columns_.layers(column); ++level)
    for (Id part = 0; part < columns_.capParts(column); ++part) {
      columns_.capRow(column, level, part, row);
      const FaceMeasures face = measureFace(points_, span(row));
      if (!(face.eta >= limits_.minEtaInternal)) return false;
      if (!holds(row, face, centre(cell, level + 1), &centre(cell, level))) return false;
    }
  return true;
}

bool LayerCheck::faceHolds(Id face) const {
  thread_local std::vector<Id> row;
  const bool inner = face < mesh_.internalFaces();
  const Id own = mesh_.owner[face], next = inner ? mesh_.neighbour[face] : kNone;
  const Id pieces = columns_.pieces(face);
  for (Id piece = 1; piece <= pieces; ++piece) {
    columns_.pieceRow(face, piece, row);
    const CellCentres* neighbour = inner ? &centre(next, columns_.layerAt(next, face, piece)) : nullptr;
    const FaceMeasures m = measureFace(points_, span(row));
    if (!holds(row, m, centre(own, columns_.layerAt(own, face, piece)), neighbour)) return false;
  }
  return true;
}

/// A failure where there is only one layer comes of points that columns beside have put on its edges.
void LayerCheck::lowerAround(Id column, std::vector<Id>& lower) const {
  std::vector<Id> near;
  columns_.around(column, near);
  Id most = 1;
  for (Id c : near) most = std::max(most, columns_.layers(c));
  if (most == 1) return;
  for (Id c : near) {
    if (columns_.layers(c) == most) lower.push_back(c);
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

std::vector<Id> LayerCheck::columnsToLower(const std::vector<Id>& changed) {
  std::vector<std::uint8_t> columnHolds(changed.size());
  forEach(changed.size(), [&](std::size_t i) { columnHolds[i] = measureColumn(changed[i]); });
  forEach(changed.size(), [&](std::size_t i) { columnHolds[i] = columnHolds[i] && capsHold(changed[i]); });
  const std::vector<Id> faces = facesAround(changed);
  std::vector<std::uint8_t> holds(faces.size());
  forEach(faces.size(), [&](std::size_t i) { holds[i] = faceHolds(faces[i]); });

  std::vector<Id> lower;
  const auto blame = [&](Id column) {
    if (columns_.layers(column) > 1) {
      lower.push_back(column);
    } else {
      lowerAround(column, lower);
    }
  };
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (!columnHolds[i]) blame(changed[i]);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (holds[i]) continue;
    const Id f = faces[i], own = mesh_.owner[f];
    const Id next = f < mesh_.internalFaces() ? mesh_.neighbour[f] : own;
    const Id most = std::max(columns_.layersOfCell(own), columns_.layersOfCell(next));
    for (Id cell : {own, next}) {
      const Id column = columns_.columnOf(cell);
      if (column != kNone && columns_.layers(column) == most) blame(column);
    }
  }
  sortUnique(lower);
  return lower;
}

}  // namespace pm
