// SPDX-License-Identifier: BSD-3-Clause
#include "CutColumns.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "LayerColumns.h"
#include "LayerLimits.h"

namespace pm {
namespace {

template <class Body>
void forEach(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
  });
}

bool isSameCycle(Span<Id> row, const std::vector<Id>& other) {
  const auto start = std::find(other.begin(), other.end(), row[0]) - other.begin();
  const std::size_t n = other.size();
  if (row.size() != n || start == static_cast<std::ptrdiff_t>(n)) return false;
  for (std::size_t i = 0; i < n; ++i)
    if (row[i] != other[(start + i) % n]) return false;
  return true;
}

/// A prism below a wall face in parts. Its first part keeps the cell, the others get new ones.
struct CutPrism {
  Id column = kNone;
  Id floor = kNone;  // the one face below
};

/// Cut prisms whose lower face has the wall's corners, ascending by column.
std::vector<CutPrism> cutPrisms(const PolyMesh& mesh, const LayerColumns& columns) {
  std::vector<CutPrism> prisms;
  for (Id c = 0; c < columns.count(); ++c) {
    const Span<Id> roof = columns.roof(c), ring = columns.ring(c);
    if (roof.size() < 2) continue;
    std::vector<Id> below;
    for (Id f : columns.facesOf(columns.cell(c)))
      if (!columns.isSide(f) && std::find(roof.begin(), roof.end(), f) == roof.end()) below.push_back(f);
    if (below.size() != 1 || below[0] >= mesh.internalFaces()) continue;
    std::vector<Id> cycle(ring.begin(), ring.end());  // as the wall runs; the lower face runs against it
    const bool owns = mesh.owner[below[0]] == columns.cell(c);
    if (owns) std::reverse(cycle.begin(), cycle.end());
    if (isSameCycle(mesh.faces[below[0]], cycle)) prisms.push_back({c, below[0]});
  }
  return prisms;
}

/// Makes the mesh in which some prisms are split.
class PrismSplitter {
 public:
  PrismSplitter(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<CutPrism>& prisms)
      : mesh_(mesh), columns_(columns), prisms_(prisms) {
    firstCell_.assign(1, mesh.cellCount);
    for (const CutPrism& p : prisms)
      firstCell_.push_back(firstCell_.back() + static_cast<Id>(columns.roof(p.column).size()) - 1);
    copyCells();
    cellOfSide();
    copyFaces();
  }
  PolyMesh take() { return std::move(out_); }
  /// Cells of a prism's parts.
  std::vector<Id> parts(std::size_t prism) const {
    std::vector<Id> cells(1, columns_.cell(prisms_[prism].column));
    for (Id c = firstCell_[prism]; c < firstCell_[prism + 1]; ++c) cells.push_back(c);
    return cells;
  }

 private:
  Id partCell(std::size_t prism, std::size_t part) const {
    return part == 0 ? columns_.cell(prisms_[prism].column) : firstCell_[prism] + static_cast<Id>(part) - 1;
  }
  void copyCells() {
    out_.points = mesh_.points;
    out_.fixed = mesh_.fixed;
    out_.base = mesh_.base;
    out_.patchNames = mesh_.patchNames;
    out_.patchTypes = mesh_.patchTypes;
    out_.finestSize = mesh_.finestSize;
    out_.stage = mesh_.stage;
    out_.level = mesh_.level;
    out_.layer = mesh_.layer;
    out_.zone = mesh_.zone;
    out_.zoneNames = mesh_.zoneNames;
    out_.cellCount = firstCell_.back();
    for (std::size_t i = 0; i < prisms_.size(); ++i) {
      const Id cell = columns_.cell(prisms_[i].column);
      for (Id c = firstCell_[i]; c < firstCell_[i + 1]; ++c) {
        out_.level.push_back(mesh_.level[cell]);
        out_.layer.push_back(mesh_.layer[cell]);
        if (!mesh_.zone.empty()) out_.zone.push_back(mesh_.zone[cell]);
      }
    }
  }

  static bool hasStep(Span<Id> row, Id from, Id to) {
    const auto n = row.size();
    for (std::size_t i = 0; i < n; ++i)
      if (row[i] == from && row[(i + 1) % n] == to) return true;
    return false;
  }
  /// The part of the wall with an edge, either way round.
  std::size_t partWithEdge(const CutPrism& p, Id a, Id b) const {
    const Span<Id> roof = columns_.roof(p.column);
    std::size_t part = 0;
    while (part < roof.size() && !hasStep(mesh_.faces[roof[part]], a, b) &&
           !hasStep(mesh_.faces[roof[part]], b, a))
      ++part;
    return part;
  }
  /// Which cells the side faces and roofs of split prisms now belong to.
  void cellOfSide() {
    owner_ = mesh_.owner;
    neighbour_ = mesh_.neighbour;
    floorPrism_.assign(mesh_.faceCount(), kNone);
    for (std::size_t i = 0; i < prisms_.size(); ++i) {
      const CutPrism& p = prisms_[i];
      const Id cell = columns_.cell(p.column);
      const Span<Id> roof = columns_.roof(p.column);
      for (std::size_t part = 0; part < roof.size(); ++part) owner_[roof[part]] = partCell(i, part);
      floorPrism_[p.floor] = static_cast<Id>(i);
      for (Id f : columns_.facesOf(cell)) {
        if (!columns_.isSide(f)) continue;
        const auto [a, b] = columns_.lowerEnds(f);
        const Id to = partCell(i, partWithEdge(p, columns_.wallPoint(a), columns_.wallPoint(b)));
        (mesh_.owner[f] == cell ? owner_[f] : neighbour_[f]) = to;
      }
    }
  }

  std::vector<Id> lowerRow(const CutPrism& p, Span<Id> wallRow) const {
    const Span<Id> ring = columns_.ring(p.column);
    std::vector<Id> row;
    for (Id wall : wallRow)
      row.push_back(
          *std::find_if(ring.begin(), ring.end(), [&](Id b) { return columns_.wallPoint(b) == wall; }));
    return row;
  }
  template <class Row>
  void addInternal(const Row& row, Id owner, Id neighbour) {
    out_.faces.push(row);
    out_.owner.push_back(owner);
    out_.neighbour.push_back(neighbour);
  }
  void addFloors(Id f, std::size_t prism) {
    const CutPrism& p = prisms_[prism];
    const Span<Id> roof = columns_.roof(p.column);
    const bool owns = mesh_.owner[f] == columns_.cell(p.column);
    for (std::size_t part = 0; part < roof.size(); ++part) {
      std::vector<Id> row = lowerRow(p, mesh_.faces[roof[part]]);
      if (owns) std::reverse(row.begin(), row.end());
      const Id cell = partCell(prism, part);
      addInternal(row, owns ? cell : owner_[f], owns ? neighbour_[f] : cell);
    }
  }
  /// The faces below the wall's inner edges.
  void addCuts(std::size_t prism) {
    const CutPrism& p = prisms_[prism];
    const Span<Id> roof = columns_.roof(p.column);
    for (std::size_t part = 0; part < roof.size(); ++part) {
      const Span<Id> row = mesh_.faces[roof[part]];
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Id a = row[k], b = row[(k + 1) % row.size()];
        for (std::size_t other = part + 1; other < roof.size(); ++other) {
          if (!hasStep(mesh_.faces[roof[other]], b, a)) continue;
          const Id ends[2] = {b, a};
          const std::vector<Id> low = lowerRow(p, {ends, ends + 2});
          addInternal(std::vector<Id>{b, a, low[1], low[0]}, partCell(prism, part), partCell(prism, other));
        }
      }
    }
  }
  void copyFaces() {
    for (Id f = 0; f < mesh_.internalFaces(); ++f) {
      if (floorPrism_[f] == kNone)
        addInternal(mesh_.faces[f], owner_[f], neighbour_[f]);
      else
        addFloors(f, floorPrism_[f]);
    }
    for (std::size_t i = 0; i < prisms_.size(); ++i) addCuts(i);
    for (Id f = mesh_.internalFaces(); f < mesh_.faceCount(); ++f) {
      out_.faces.push(mesh_.faces[f]);
      out_.owner.push_back(owner_[f]);
    }
    out_.patch = mesh_.patch;
  }

  const PolyMesh& mesh_;
  const LayerColumns& columns_;
  const std::vector<CutPrism>& prisms_;
  PolyMesh out_;
  std::vector<Id> firstCell_;  // of each prism: the cell of its second part
  std::vector<Id> owner_, neighbour_, floorPrism_;
};

/// Measures what a split touches, and says which splits are to be taken back.
class SplitCheck {
 public:
  SplitCheck(const PolyMesh& mesh, const QualityLimits& limits)
      : mesh_(mesh), limits_(limits, mesh.finestSize), cellFaces_(cellFaces(mesh)), prisms_(mesh.cellCount) {}

  void add(Id cell, Id prism) {
    if (prisms_[cell].empty()) cells_.push_back(cell);
    prisms_[cell].push_back(prism);
  }
  /// The prisms of those cells that break a limit or have a face that does.
  std::vector<char> broken(std::size_t prismCount) {
    measureAll();
    std::vector<char> fails(prismCount, 0);
    std::vector<char> cellFails(cells_.size(), 0);
    forEach(cells_.size(), [&](std::size_t i) { cellFails[i] = !holds(cells_[i]); });
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (cellFails[i])
        for (Id prism : prisms_[cells_[i]]) fails[prism] = 1;
    return fails;
  }

 private:
  void measureAll() {
    faces_.resize(mesh_.faceCount());
    measures_.resize(mesh_.cellCount);
    std::vector<Id> near;
    for (Id c : cells_)
      for (Id f : cellFaces_[c]) {
        near.push_back(mesh_.owner[f]);
        if (f < mesh_.internalFaces()) near.push_back(mesh_.neighbour[f]);
      }
    sortUnique(near);
    std::vector<Id> rim;
    for (Id c : near) rim.insert(rim.end(), cellFaces_[c].begin(), cellFaces_[c].end());
    sortUnique(rim);
    forEach(rim.size(),
            [&](std::size_t i) { faces_[rim[i]] = measureFace(mesh_.points, mesh_.faces[rim[i]]); });
    forEach(near.size(), [&](std::size_t i) {
      thread_local std::vector<Id> points;
      points.clear();
      for (Id f : cellFaces_[near[i]])
        points.insert(points.end(), mesh_.faces[f].begin(), mesh_.faces[f].end());
      sortUnique(points);
      measures_[near[i]] = measureCell(mesh_, near[i], cellFaces_[near[i]],
                                       Span<Id>{points.data(), points.data() + points.size()},
                                       [&](Id f) { return faces_[f].centre; });
    });
  }
  bool holds(Id cell) const {
    if (limits_.ofCell(measures_[cell])) return false;
    for (Id f : cellFaces_[cell]) {
      const bool inner = f < mesh_.internalFaces();
      const CellCentres owner(measures_[mesh_.owner[f]]);
      const CellCentres next = inner ? CellCentres(measures_[mesh_.neighbour[f]]) : CellCentres();
      const QualityLimits& values = limits_.values();
      if (limits_.ofShape(faces_[f], inner ? values.minEtaInternal : values.minEtaBoundary) ||
          limits_.ofFace(mesh_.points, mesh_.faces[f], faces_[f], owner, inner ? &next : nullptr))
        return false;
    }
    return true;
  }

  const PolyMesh& mesh_;
  LayerLimits limits_;
  Csr<Id> cellFaces_;
  std::vector<std::vector<Id>> prisms_;  // of each cell: those that touch it
  std::vector<Id> cells_;
  std::vector<FaceMeasures> faces_;
  std::vector<CellMeasures> measures_;
};

}  // namespace

PolyMesh splitCutColumns(const PolyMesh& mesh, const QualityLimits& limits, Monitor& monitor) {
  const LayerColumns columns(mesh);
  std::vector<CutPrism> prisms = cutPrisms(mesh, columns);
  while (!prisms.empty()) {
    monitor.check(0.02, "splitting cut prisms");
    PrismSplitter splitter(mesh, columns, prisms);
    PolyMesh split = splitter.take();
    SplitCheck check(split, limits);
    for (std::size_t i = 0; i < prisms.size(); ++i) {
      for (Id c : splitter.parts(i)) check.add(c, static_cast<Id>(i));
      const Id f = prisms[i].floor, own = columns.cell(prisms[i].column);
      check.add(mesh.owner[f] == own ? mesh.neighbour[f] : mesh.owner[f], static_cast<Id>(i));
    }
    const std::vector<char> broken = check.broken(prisms.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < prisms.size(); ++i)
      if (!broken[i]) prisms[kept++] = prisms[i];
    if (kept == prisms.size()) {
      canonicalise(split);
      return split;
    }
    prisms.resize(kept);
  }
  return mesh;
}

}  // namespace pm
