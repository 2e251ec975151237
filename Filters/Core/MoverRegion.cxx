// SPDX-License-Identifier: BSD-3-Clause
#include "MoverRegion.h"

#include <algorithm>
#include <numeric>

#include "SortedRows.h"

namespace pm {
namespace {

using Marks = std::vector<std::uint8_t>;

/// Marks both cells of every face that holds a marked point: all cells of those points.
Marks cellsOfMarked(const PolyMesh& mesh, const Marks& points) {
  Marks cells(mesh.cellCount, 0);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    if (std::none_of(row.begin(), row.end(), [&](Id p) { return points[p] != 0; })) continue;
    cells[mesh.owner[f]] = 1;
    if (f < mesh.internalFaces()) cells[mesh.neighbour[f]] = 1;
  }
  return cells;
}

/// Numbers marked items from `first` on; returns the next number.
Id number(const Marks& marks, std::vector<Id>& slots, Id first = 0) {
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (marks[i]) slots[i] = first++;
  return first;
}

/// Rows of `count` slots from pairs (slot, value) that forEachPair(body) passes to body in the order wanted.
template <class ForEachPair>
Csr<Id> collectRows(Id count, const ForEachPair& forEachPair) {
  Csr<Id> rows;
  rows.offsets.assign(static_cast<std::size_t>(count) + 1, 0);
  forEachPair([&](Id slot, Id) { ++rows.offsets[slot + 1]; });
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.values.resize(rows.offsets.back());
  // Each offset moves to the end of its row, the next row's start, and all are put back one place on.
  forEachPair([&](Id slot, Id value) { rows.values[rows.offsets[slot]++] = value; });
  std::rotate(rows.offsets.rbegin(), rows.offsets.rbegin() + 1, rows.offsets.rend());
  rows.offsets[0] = 0;
  return rows;
}

/// Gives rows of faces other boundary faces, from pairs (slot, face) in ascending order of faces; the
/// internal faces in them stay. In place, for a second copy of such rows would be a stage's largest need of
/// memory.
template <class ForEachPair>
void exchangeBoundary(Csr<Id>& rows, Id internalFaces, const ForEachPair& forEachPair) {
  const Csr<Id> boundary = collectRows(rows.rows(), forEachPair);
  // Internal faces move together, forwards; then apart, backwards, to leave room for the others.
  auto end = rows.values.begin();
  for (Id i = 0; i < rows.rows(); ++i) {
    const auto first = rows.values.begin() + rows.offsets[i],
               last = rows.values.begin() + rows.offsets[i + 1];
    rows.offsets[i] = static_cast<Id>(end - rows.values.begin());
    end = std::copy(first, std::lower_bound(first, last, internalFaces), end);
  }
  Id internalEnd = static_cast<Id>(end - rows.values.begin());
  rows.values.resize(internalEnd + boundary.values.size());
  auto next = rows.values.end();
  for (Id i = rows.rows(); i-- > 0;) {
    rows.offsets[i + 1] = static_cast<Id>(next - rows.values.begin());
    next = std::copy_backward(boundary[i].begin(), boundary[i].end(), next);
    const auto first = rows.values.begin() + rows.offsets[i];
    next = std::copy_backward(first, rows.values.begin() + internalEnd, next);
    internalEnd = rows.offsets[i];
  }
}

}  // namespace

Csr<Id> facesOfSlots(const PolyMesh& mesh, const std::vector<Id>& cellSlot, Id first, Id last) {
  return collectRows(last - first, [&](const auto& body) {
    const auto add = [&](Id cell, Id f) {
      const Id slot = cellSlot[cell];
      if (slot >= first && slot < last) body(slot - first, f);
    };
    for (Id f = 0; f < mesh.faceCount(); ++f) {
      add(mesh.owner[f], f);
      if (f < mesh.internalFaces()) add(mesh.neighbour[f], f);
    }
  });
}

Csr<Id> pointsOfRows(const PolyMesh& mesh, const Csr<Id>& faceRows) {
  return sortedRows(faceRows.rows(), [&](Id i, std::vector<Id>& points) {
    for (Id f : faceRows[i]) points.insert(points.end(), mesh.faces[f].begin(), mesh.faces[f].end());
  });
}

MoverRegion::MoverRegion(const PolyMesh& mesh, const std::vector<Id>* movable)
    : pointSlot(mesh.points.size(), kNone),
      faceSlot(mesh.faceCount(), kNone),
      cellSlot(mesh.cellCount, kNone) {
  Marks marks(mesh.points.size(), movable == nullptr);
  if (movable != nullptr)
    for (Id p : *movable) marks[p] = 1;
  points = number(marks, pointSlot);
  const Marks inner = cellsOfMarked(mesh, marks);
  Marks rim(mesh.cellCount, 0);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Id own = mesh.owner[f], next = f < mesh.internalFaces() ? mesh.neighbour[f] : own;
    if (!inner[own] && !inner[next]) continue;
    faceSlot[f] = faces++;
    for (Id c : {own, next}) rim[c] = !inner[c];
  }
  cells = number(inner, cellSlot);
  cellsAndRim = number(rim, cellSlot, cells);

  cellFaces = facesOfSlots(mesh, cellSlot, 0, cells);
  cellPoints = pointsOfRows(mesh, cellFaces);
  pointFaces = collectRows(points, [&](const auto& body) {
    for (Id f = 0; f < mesh.faceCount(); ++f)
      for (Id p : mesh.faces[f])
        if (pointSlot[p] != kNone) body(pointSlot[p], f);
  });
  pointCells = collectRows(points, [&](const auto& body) {
    for (Id c = 0; c < mesh.cellCount; ++c) {
      if (!inner[c]) continue;
      for (Id p : cellPoints[cellSlot[c]])
        if (pointSlot[p] != kNone) body(pointSlot[p], c);
    }
  });
}

void MoverRegion::renewBoundary(const PolyMesh& mesh) {
  const Id internal = mesh.internalFaces();
  faceSlot.resize(internal);
  faceSlot.resize(mesh.faceCount(), kNone);
  const auto lastSlot =
      std::find_if(faceSlot.rend() - internal, faceSlot.rend(), [](Id s) { return s != kNone; });
  faces = lastSlot == faceSlot.rend() ? 0 : *lastSlot + 1;
  for (Id f = internal; f < mesh.faceCount(); ++f)
    if (isInner(mesh.owner[f])) faceSlot[f] = faces++;
  exchangeBoundary(cellFaces, internal, [&](const auto& body) {
    for (Id f = internal; f < mesh.faceCount(); ++f)
      if (faceSlot[f] != kNone) body(cellSlot[mesh.owner[f]], f);
  });
  exchangeBoundary(pointFaces, internal, [&](const auto& body) {
    for (Id f = internal; f < mesh.faceCount(); ++f)
      for (Id p : mesh.faces[f])
        if (pointSlot[p] != kNone) body(pointSlot[p], f);
  });
}

std::vector<Id> nextRing(const PolyMesh& mesh, std::vector<std::uint8_t>& marked) {
  const Marks cells = cellsOfMarked(mesh, marked);
  Marks now = marked;
  for (Id f = 0; f < mesh.faceCount(); ++f)
    if (cells[mesh.owner[f]] || (f < mesh.internalFaces() && cells[mesh.neighbour[f]]))
      for (Id p : mesh.faces[f]) now[p] = 1;
  std::vector<Id> ring;
  for (std::size_t p = 0; p < now.size(); ++p)
    if (now[p] && !marked[p]) ring.push_back(static_cast<Id>(p));
  marked.swap(now);
  return ring;
}

std::vector<Id> pointsNearWall(const PolyMesh& mesh, int rings) {
  Marks marked(mesh.points.size(), 0);
  std::vector<Id> points;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.base[p] != kNone) marked[p] = marked[mesh.base[p]] = 1;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (marked[p]) points.push_back(static_cast<Id>(p));
  for (int k = 0; k < rings; ++k) {
    const std::vector<Id> ring = nextRing(mesh, marked);
    points.insert(points.end(), ring.begin(), ring.end());
  }
  return points;
}

}  // namespace pm
