// SPDX-License-Identifier: BSD-3-Clause
#include "CutAssembly.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "PolygonPrism.h"

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
  Id newCell;   // that it is a face of, from 0
  bool turned;  // the cell is the neighbour of the piece's face
};

/// A directed edge of a piece.
struct PieceEdge {
  Id low, high, piece;
  bool upward;  // runs from low to high
};

/// A face between two new cells of an old one; it leaves `cell`.
struct InnerFace {
  Piece piece;
  Id cell, other;
};

/// One old cell while it is cut; its buffers are used again for the next. Ids of points: the mesh's, then the
/// centres of faces, then those of cells.
class CellCutter {
 public:
  CellCutter(const PolyMesh& mesh, const CellCuts& cuts, const Csr<Id>& facesOf,
             const std::vector<Id>& pieceStart)
      : mesh_(mesh), cuts_(cuts), facesOf_(facesOf), pieceStart_(pieceStart) {}

  void cut(Id cell) {
    sides_.clear();
    inner_.clear();
    newCells_ = 1;
    const Id apex = cuts_.apex[cell];
    if (apex == CellCuts::kWhole)
      for (Id f : facesOf_[cell]) sides_.push_back({{}, pieceStart_[f], 0, mesh_.owner[f] != cell});
    else if (apex == CellCuts::kWedges)
      cutIntoWedges(cell);
    else
      cutIntoCones(cell, apex);
  }

  Id newCells() const { return newCells_; }
  const std::vector<SidePiece>& sides() const { return sides_; }
  const std::vector<InnerFace>& inner() const { return inner_; }

 private:
  Id faceCentre(Id f) const { return static_cast<Id>(mesh_.points.size()) + f; }

  template <class Body>
  void forEachSide(Id cell, const Body& body) {
    for (Id f : facesOf_[cell]) {
      Id number = pieceStart_[f];
      const bool turned = mesh_.owner[f] != cell;
      forEachPiece(mesh_.faces[f], cuts_.fan[f], faceCentre(f), turned, [&](const Piece& piece) {
        sides_.push_back({piece, number++, body(piece), turned});
      });
    }
  }

  void cutIntoCones(Id cell, Id apex) {
    newCells_ = 0;
    forEachSide(cell, [&](const Piece& piece) { return apex >= 0 && piece.has(apex) ? kNone : newCells_++; });
    const Id tip = apex >= 0 ? apex : faceCentre(mesh_.faceCount()) + cell;
    sortEdges();
    // Beyond an edge of a piece that holds the apex is the one cone that this piece is a face of.
    for (std::size_t i = 0; i + 1 < edges_.size(); i += 2) {
      const PieceEdge& edge = edges_[i];
      SidePiece &a = sides_[edge.piece], &b = sides_[edges_[i + 1].piece];
      const bool coneA = !a.piece.has(tip), coneB = !b.piece.has(tip);
      if (coneA && !coneB) b.newCell = a.newCell;
      if (coneB && !coneA) a.newCell = b.newCell;
      if (!coneA || !coneB) continue;
      const Id from = edge.upward ? edge.low : edge.high, to = edge.upward ? edge.high : edge.low;
      inner_.push_back({{{to, from, tip, kNone}, 3}, a.newCell, b.newCell});
    }
  }

  void sortEdges() {
    edges_.clear();
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
  }

  /// Wedge i lies over corners 0, i + 1 and i + 2 of the base, counted from where its fan begins.
  void cutIntoWedges(Id cell) {
    PolygonPrism prism;
    findPrism(mesh_, facesOf_[cell], cell, prism);
    const std::size_t n = prism.size();
    const std::size_t start = prism.cornerOf(mesh_.faces[prism.base][cuts_.fan[prism.base]]);
    newCells_ = static_cast<Id>(n) - 2;
    forEachSide(cell, [&](const Piece& piece) {
      std::size_t least = n, most = 0;
      for (int i = 0; i < piece.size; ++i) {
        const std::size_t corner = (prism.cornerOf(piece.corner[i]) + n - start) % n;
        if (corner > 0) least = std::min(least, corner);
        most = std::max(most, corner);
      }
      // Corners 0, 1 and 0, n - 1 are those of the outer quads of the first and the last wedge.
      return static_cast<Id>(most == least && least == 1 ? 0 : most - 2);
    });
    for (std::size_t i = 2; i + 1 < n; ++i) {
      const std::size_t corner = prism.next(start, i);
      const Piece quad{{prism.below[start], prism.below[corner], prism.above[corner], prism.above[start]}, 4};
      inner_.push_back({quad, static_cast<Id>(i) - 2, static_cast<Id>(i) - 1});
    }
  }

  const PolyMesh& mesh_;
  const CellCuts& cuts_;
  const Csr<Id>& facesOf_;
  const std::vector<Id>& pieceStart_;
  Id newCells_ = 0;
  std::vector<SidePiece> sides_;
  std::vector<InnerFace> inner_;
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
      inner[c] = static_cast<Id>(cutter.inner().size());
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
    const Id points = static_cast<Id>(mesh_.points.size()), faces = mesh_.faceCount();
    if (point < points) return point;
    return point < points + faces ? facePoint_[point - points] : cellPoint_[point - points - faces];
  }

  /// Rows of all faces: internal pieces, faces inside old cells (of quads where they are wedges), boundary
  /// pieces.
  void fillPieces() {
    monitor_.check(0.4, "cutting faces");
    const Id internal = mesh_.internalFaces(), inner = innerStart_.back();
    const Id pieces = pieceStart_.back(), firstBoundary = pieceStart_[internal];
    std::vector<Id>& offsets = out_.faces.offsets;
    offsets.assign(static_cast<std::size_t>(pieces) + inner + 1, 0);
    tbb::parallel_for(Id(0), mesh_.cellCount, [&](Id c) {
      std::fill(offsets.begin() + 1 + firstBoundary + innerStart_[c],
                offsets.begin() + 1 + firstBoundary + innerStart_[c + 1],
                cuts_.apex[c] == CellCuts::kWedges ? 4 : 3);
    });
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
      for (const SidePiece& side : cutter.sides()) {
        const Id face = side.number < firstBoundary ? side.number : side.number + inner;
        (side.turned ? out_.neighbour : out_.owner)[face] = first + side.newCell;
      }
      Id face = firstBoundary + innerStart_[c];
      for (const InnerFace& found : cutter.inner()) {
        out_.owner[face] = first + found.cell;
        out_.neighbour[face] = first + found.other;
        Id* row = out_.faces.values.data() + out_.faces.offsets[face++];
        for (int i = 0; i < found.piece.size; ++i) row[i] = finalId(found.piece.corner[i]);
      }
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
