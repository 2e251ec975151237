// SPDX-License-Identifier: BSD-3-Clause
#include "LayerCheck.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

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

LayerReason faceFault(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                      const CellCentres& owner, const CellCentres* neighbour, const QualityLimits& limits) {
  if (face.warpage() > limits.maxWarpage) return LayerReason::Warpage;
  if (neighbour == nullptr) {
    if (faceAngle(face.normal, face.centre - owner.thesis) > limits.maxAngleBoundary)
      return LayerReason::AngleBoundary;
    return boundarySkewness(points, row, face, owner.foam) > limits.maxSkewBoundary ? LayerReason::Skewness
                                                                                    : LayerReason::None;
  }
  if (faceAngle(face.normal, neighbour->thesis - owner.thesis) > limits.maxAngleInternal ||
      faceAngle(face.normal, neighbour->foam - owner.foam) > limits.maxAngleInternal)
    return LayerReason::AngleInternal;
  return internalSkewness(points, row, face, owner.foam, neighbour->foam) > limits.maxSkewInternal
             ? LayerReason::Skewness
             : LayerReason::None;
}

bool cellHolds(const CellMeasures& cell, const QualityLimits& limits, double unit) {
  // A hair above zero, so that rounding in another program does not find it negative.
  const double least = std::max(limits.minTet * unit * unit * unit, 1e-6 * cell.volume);
  return cell.volume > 0 && std::min(cell.minTet, cell.minPyramid) > least;
}

LayerCheck::LayerCheck(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<Vec3>& points,
                       const QualityLimits& limits)
    : mesh_(mesh), columns_(columns), points_(points), limits_(limits) {
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
  forEach(beside.size(), [&](std::size_t i) { measureBeside(beside[i]); });
}

void LayerCheck::measureBeside(Id cell) {
  thread_local CellFaces faces;
  faces.clear();
  for (Id f : columns_.facesOf(cell)) {
    faces.row.assign(mesh_.faces[f].begin(), mesh_.faces[f].end());
    faces.add(mesh_.owner[f] == cell ? 1 : -1);
  }
  otherCentres_[cell] = CellCentres(faces.measure(points_));
}

const CellCentres& LayerCheck::centre(Id cell, Id layer) const {
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
      columns_.capRow(column, level, faces.row);
      faces.add(level < layer ? 1 : -1);
    }
    const CellMeasures m = faces.measure(points_);
    centres_[centreStart_[column] + layer - 1] = CellCentres(m);
    good = good && cellHolds(m, limits_, mesh_.finestSize);
  }
  return good;
}

LayerReason LayerCheck::capFault(Id column) const {
  thread_local std::vector<Id> row;
  const Id cell = columns_.cell(column);
  for (Id level = 1; level < columns_.layers(column); ++level) {
    columns_.capRow(column, level, row);
    const FaceMeasures face = measureFace(points_, span(row));
    if (!(face.eta >= limits_.minEtaInternal)) return LayerReason::FaceShape;
    const LayerReason fault =
        faceFault(points_, span(row), face, centre(cell, level + 1), &centre(cell, level), limits_);
    if (fault != LayerReason::None) return fault;
  }
  return LayerReason::None;
}

LayerReason LayerCheck::faultOf(Id face) const {
  thread_local std::vector<Id> row;
  const bool inner = face < mesh_.internalFaces();
  const Id own = mesh_.owner[face], next = inner ? mesh_.neighbour[face] : kNone;
  const Id pieces = columns_.pieces(face);
  for (Id piece = 1; piece <= pieces; ++piece) {
    columns_.pieceRow(face, piece, row);
    const CellCentres* neighbour = inner ? &centre(next, columns_.layerAt(next, face, piece)) : nullptr;
    const CellCentres& owner = centre(own, columns_.layerAt(own, face, piece));
    const LayerReason fault =
        faceFault(points_, span(row), measureFace(points_, span(row)), owner, neighbour, limits_);
    if (fault != LayerReason::None) return fault;
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

int LayerCheck::countFaults(const std::vector<Id>& columns) {
  int count = 0;
  for (Id c : columns) count += !measureColumn(c);
  for (Id c : columns) count += capFault(c) != LayerReason::None;
  for (Id f : facesAround(columns)) count += faultOf(f) != LayerReason::None;
  return count;
}

std::vector<LayerCheck::Fault> LayerCheck::columnsToLower(const std::vector<Id>& changed) {
  std::vector<LayerReason> ofColumn(changed.size(), LayerReason::None);
  forEach(changed.size(), [&](std::size_t i) {
    if (!measureColumn(changed[i])) ofColumn[i] = LayerReason::FoldedCell;
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
