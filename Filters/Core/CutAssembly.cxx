// SPDX-License-Identifier: BSD-3-Clause
#include "CutAssembly.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

/// Starts of rows from their lengths in starts[1..], and the check that ids can name the total.
std::vector<Id> sumUp(const std::vector<Id>& lengths) {
  std::vector<Id> starts(lengths.size() + 1, 0);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    sum += lengths[i];
    if (sum > std::numeric_limits<Id>::max() / 8)  // a cell has four faces of three points
      throw BudgetError(
          "The converted mesh would have more cells than the program can number; convert a mesh of larger "
          "cells, or choose the hybrid shapes, which are fewer.");
    starts[i + 1] = static_cast<Id>(sum);
  }
  return starts;
}

/// A piece of one of a cell's faces, out of the cell.
struct SidePiece {
  Piece piece;
  Id number;    // among all pieces
  Id newCell;   // of the cone on it, from 0; kNone when the apex is one of its corners
  bool turned;  // the cell is the neighbour of the piece's face
};

/// A directed edge of a piece.
struct PieceEdge {
  Id low, high, piece;
  bool upward;  // runs from low to high
};

/// One old cell while it is cut; its buffers are used again for the next.
class CellCutter {
 public:
  CellCutter(const PolyMesh& mesh, const CellCuts& cuts, const Csr<Id>& facesOf,
             const std::vector<Id>& pieceStart)
      : mesh_(mesh), cuts_(cuts), facesOf_(facesOf), pieceStart_(pieceStart) {}

  void cut(Id cell) {
    sides_.clear();
    newCells_ = 0;
    const Id apex = cuts_.apex[cell];
    for (Id f : facesOf_[cell]) {
      Id number = pieceStart_[f];
      if (apex == CellCuts::kWhole) {
        sides_.push_back({{}, number, 0, mesh_.owner[f] != cell});
        continue;
      }
      forEachPiece(mesh_.faces[f], cuts_.fan[f], static_cast<Id>(mesh_.points.size()) + f,
                   mesh_.owner[f] != cell, [&](const Piece& piece) {
                     const Id newCell = apex >= 0 && piece.has(apex) ? kNone : newCells_++;
                     sides_.push_back({piece, number++, newCell, mesh_.owner[f] != cell});
                   });
    }
    edges_.clear();
    if (apex == CellCuts::kWhole)
      newCells_ = 1;
    else
      pairEdges();
  }

  Id newCells() const { return newCells_; }
  /// Faces between two new cells: one for each edge between two pieces that have cones.
  Id innerFaces() const {
    Id count = 0;
    forEachInner([&](Id, Id, Id, Id) { ++count; });
    return count;
  }
  const std::vector<SidePiece>& sides() const { return sides_; }

  /// Calls body(p, q, newCell, other) for inner faces: q, p, apex leaves newCell.
  template <class Body>
  void forEachInner(const Body& body) const {
    for (std::size_t i = 0; i + 1 < edges_.size(); i += 2) {
      const PieceEdge& edge = edges_[i];
      const Id cell = sides_[edge.piece].newCell, other = sides_[edges_[i + 1].piece].newCell;
      if (cell == kNone || other == kNone) continue;
      if (edge.upward)
        body(edge.low, edge.high, cell, other);
      else
        body(edge.high, edge.low, cell, other);
    }
  }

 private:
  /// Edges in pairs; a piece that holds the apex is a face of the cone beyond its one edge that does not.
  void pairEdges() {
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const Piece& piece = sides_[s].piece;
      for (int i = 0; i < piece.size; ++i) {
        const Id p = piece.corner[i], q = piece.corner[(i + 1) % piece.size];
        edges_.push_back({std::min(p, q), std::max(p, q), static_cast<Id>(s), p < q});
      }
    }
    std::sort(edges_.begin(), edges_.end(), [](const PieceEdge& a, const PieceEdge& b) {
      return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.piece < b.piece;
    });
    owner_.assign(sides_.size(), kNone);
    for (std::size_t i = 0; i + 1 < edges_.size(); i += 2) {
      SidePiece &a = sides_[edges_[i].piece], &b = sides_[edges_[i + 1].piece];
      if (a.newCell == kNone && b.newCell != kNone) owner_[edges_[i].piece] = b.newCell;
      if (b.newCell == kNone && a.newCell != kNone) owner_[edges_[i + 1].piece] = a.newCell;
    }
  }

 public:
  /// The new cell that has a side's piece as a face.
  Id cellOfSide(std::size_t s) const { return sides_[s].newCell != kNone ? sides_[s].newCell : owner_[s]; }

 private:
  const PolyMesh& mesh_;
  const CellCuts& cuts_;
  const Csr<Id>& facesOf_;
  const std::vector<Id>& pieceStart_;
  Id newCells_ = 0;
  std::vector<SidePiece> sides_;
  std::vector<Id> owner_;  // of a side whose piece holds the apex
  std::vector<PieceEdge> edges_;
};

class Assembly {
 public:
  Assembly(const PolyMesh& mesh, const CellCuts& cuts, Monitor& monitor)
      : mesh_(mesh), cuts_(cuts), monitor_(monitor), facesOf_(cellFaces(mesh)) {}

  PolyMesh build(std::vector<Id>& firstCell) {
    countAll();
    placePoints();
    fillPieces();
    fillCells();
    monitor_.check(0.7, "ordering faces");
    canonicalise(out_);
    firstCell = std::move(cellStart_);
    return std::move(out_);
  }

 private:
  /// Calls body(cell, cutter) for all cells, each cut.
  template <class Body>
  void forEachCell(double fraction, const Body& body) {
    constexpr Id kChunk = 1 << 17;
    for (Id first = 0; first < mesh_.cellCount; first += std::min(kChunk, mesh_.cellCount - first)) {
      monitor_.check(fraction, "joining cells");
      const Id last = first + std::min(kChunk, mesh_.cellCount - first);
      tbb::parallel_for(tbb::blocked_range<Id>(first, last, 256), [&](const tbb::blocked_range<Id>& block) {
        CellCutter cutter(mesh_, cuts_, facesOf_, pieceStart_);
        for (Id c = block.begin(); c != block.end(); ++c) {
          cutter.cut(c);
          body(c, cutter);
        }
      });
    }
  }

  void countAll() {
    std::vector<Id> pieces(mesh_.faceCount());
    tbb::parallel_for(Id(0), mesh_.faceCount(),
                      [&](Id f) { pieces[f] = countPieces(cuts_.fan[f], mesh_.faces[f].size()); });
    pieceStart_ = sumUp(pieces);
    std::vector<Id> cells(mesh_.cellCount), inner(mesh_.cellCount);
    forEachCell(0.1, [&](Id c, const CellCutter& cutter) {
      cells[c] = cutter.newCells();
      inner[c] = cutter.innerFaces();
    });
    cellStart_ = sumUp(cells);
    innerStart_ = sumUp(inner);
  }

  /// Ids of new points, and their coordinates.
  void placePoints() {
    out_.points = mesh_.points;
    out_.fixed = mesh_.fixed;
    cellPoint_.assign(mesh_.cellCount, kNone);
    facePoint_.assign(mesh_.faceCount(), kNone);
    const auto add = [&](const Vec3& at, std::uint8_t fixed) {
      out_.points.push_back(at);
      out_.fixed.push_back(fixed);
      return static_cast<Id>(out_.points.size()) - 1;
    };
    for (Id c = 0; c < mesh_.cellCount; ++c)
      if (cuts_.apex[c] == CellCuts::kCentre) cellPoint_[c] = add(cuts_.cellCentre[c], 0);
    for (Id f = 0; f < mesh_.faceCount(); ++f) {
      if (cuts_.fan[f] != CellCuts::kCentre) continue;
      std::uint8_t fixed = f < mesh_.internalFaces() ? 0 : 7;
      for (Id p : mesh_.faces[f]) fixed &= mesh_.fixed[p];
      facePoint_[f] = add(cuts_.faceCentre[f], fixed);
    }
    out_.base.assign(out_.points.size(), kNone);
  }

  Id finalId(Id point) const {
    const Id count = static_cast<Id>(mesh_.points.size());
    return point < count ? point : facePoint_[point - count];
  }

  /// Rows of all faces: internal pieces, faces inside old cells (three points each), boundary pieces.
  void fillPieces() {
    monitor_.check(0.4, "cutting faces");
    const Id internal = mesh_.internalFaces(), inner = innerStart_.back();
    const Id pieces = pieceStart_.back(), firstBoundary = pieceStart_[internal];
    std::vector<Id>& offsets = out_.faces.offsets;
    offsets.assign(static_cast<std::size_t>(pieces) + inner + 1, 0);
    std::fill_n(offsets.begin() + 1 + firstBoundary, inner, 3);
    out_.patch.resize(pieces - firstBoundary);
    const auto newFace = [&](Id piece) { return piece < firstBoundary ? piece : piece + inner; };
    tbb::parallel_for(Id(0), mesh_.faceCount(), [&](Id f) {
      const Id size = cuts_.fan[f] == CellCuts::kWhole ? static_cast<Id>(mesh_.faces[f].size()) : 3;
      for (Id piece = pieceStart_[f]; piece < pieceStart_[f + 1]; ++piece) {
        offsets[newFace(piece) + 1] = size;
        if (f >= internal) out_.patch[piece - firstBoundary] = mesh_.patch[f - internal];
      }
    });
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    out_.faces.values.resize(offsets.back());
    tbb::parallel_for(Id(0), mesh_.faceCount(), [&](Id f) {
      const Span<Id> row = mesh_.faces[f];
      Id* to = out_.faces.values.data() + offsets[newFace(pieceStart_[f])];
      if (cuts_.fan[f] == CellCuts::kWhole) {
        std::copy(row.begin(), row.end(), to);
        return;
      }
      forEachPiece(row, cuts_.fan[f], static_cast<Id>(mesh_.points.size()) + f, false,
                   [&](const Piece& piece) {
                     for (int i = 0; i < piece.size; ++i) *to++ = finalId(piece.corner[i]);
                   });
    });
    out_.owner.resize(pieces + inner);
    out_.neighbour.resize(firstBoundary + inner);
  }

  void fillCells() {
    out_.cellCount = cellStart_.back();
    out_.level.resize(out_.cellCount);
    out_.layer.resize(out_.cellCount);
    out_.zone.resize(mesh_.zone.empty() ? 0 : out_.cellCount);
    const Id inner = innerStart_.back(), firstBoundary = pieceStart_[mesh_.internalFaces()];
    forEachCell(0.5, [&](Id c, const CellCutter& cutter) {
      const Id first = cellStart_[c];
      for (Id n = first; n < cellStart_[c + 1]; ++n) {
        out_.level[n] = mesh_.level[c];
        out_.layer[n] = mesh_.layer[c];
        if (!mesh_.zone.empty()) out_.zone[n] = mesh_.zone[c];
      }
      for (std::size_t s = 0; s < cutter.sides().size(); ++s) {
        const SidePiece& side = cutter.sides()[s];
        const Id face = side.number < firstBoundary ? side.number : side.number + inner;
        (side.turned ? out_.neighbour : out_.owner)[face] = first + cutter.cellOfSide(s);
      }
      const Id apex = cuts_.apex[c] == CellCuts::kCentre ? cellPoint_[c] : cuts_.apex[c];
      Id face = firstBoundary + innerStart_[c];
      cutter.forEachInner([&](Id p, Id q, Id cell, Id other) {
        out_.owner[face] = first + cell;
        out_.neighbour[face] = first + other;
        Id* row = out_.faces.values.data() + out_.faces.offsets[face++];
        row[0] = finalId(q);
        row[1] = finalId(p);
        row[2] = apex;
      });
    });
    out_.patchNames = mesh_.patchNames;
    out_.patchTypes = mesh_.patchTypes;
    out_.zoneNames = mesh_.zoneNames;
    out_.finestSize = mesh_.finestSize;
    out_.stage = mesh_.stage;
  }

  const PolyMesh& mesh_;
  const CellCuts& cuts_;
  Monitor& monitor_;
  const Csr<Id> facesOf_;
  std::vector<Id> pieceStart_;              // #F+1
  std::vector<Id> cellStart_, innerStart_;  // #C+1
  std::vector<Id> cellPoint_, facePoint_;   // #C, #F ids of new points
  PolyMesh out_;
};

}  // namespace

PolyMesh assembleCuts(const PolyMesh& mesh, const CellCuts& cuts, Monitor& monitor,
                      std::vector<Id>& firstCell) {
  return Assembly(mesh, cuts, monitor).build(firstCell);
}

}  // namespace pm
