// SPDX-License-Identifier: BSD-3-Clause
#include "LayerColumns.h"

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

constexpr Id kAmbiguous = -2;  // a lower point joined to several wall points: its edges stay whole

/// Calls body(p, q) for each pair of consecutive points of a face.
template <class Body>
void forEachPair(Span<Id> row, const Body& body) {
  Id p = row[row.size() - 1];
  for (Id q : row) {
    body(p, q);
    p = q;
  }
}

/// Rows of the inverse relation: row v lists the rows of `of` that hold v, ascending.
Csr<Id> invert(const Csr<Id>& of, std::size_t count) {
  Csr<Id> rows;
  rows.offsets.assign(count + 1, 0);
  for (Id v : of.values) ++rows.offsets[v + 1];
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.values.resize(rows.offsets.back());
  std::vector<Id> next(rows.offsets.begin(), rows.offsets.end() - 1);
  for (Id i = 0; i < of.rows(); ++i) {
    for (Id v : of[i]) rows.values[next[v]++] = i;
  }
  return rows;
}

}  // namespace

LayerColumns::LayerColumns(const PolyMesh& mesh) : mesh_(mesh), facesOfCell_(cellFaces(mesh)) {
  findEdges();
  findSides();
  findColumns();
  edgeColumns_ = invert(edges_, mesh.points.size());
  layers_.assign(cells_.size(), 1);
  reason_.assign(cells_.size(), LayerReason::NoPrism);
  pinched_.assign(mesh.points.size(), 0);
  edgeLayers_.assign(mesh.points.size(), 1);
  firstPoint_.assign(mesh.points.size(), kNone);
}

void LayerColumns::findEdges() {
  top_.assign(mesh_.points.size(), kNone);
  const auto isWall = [&](Id p) { return mesh_.base[p] != kNone; };
  for (Id f = 0; f < mesh_.faceCount(); ++f) {
    forEachPair(mesh_.faces[f], [&](Id p, Id q) {
      if (isWall(p) == isWall(q)) return;
      const Id wall = isWall(p) ? p : q, lower = isWall(p) ? q : p;
      if (top_[lower] == kNone) {
        top_[lower] = wall;
      } else if (top_[lower] != wall) {
        top_[lower] = kAmbiguous;
      }
    });
  }
}

void LayerColumns::findSides() {
  sideStart_.assign(mesh_.faceCount(), kNotSide);
  for (Id f = 0; f < mesh_.faceCount(); ++f) {
    const Span<Id> row = mesh_.faces[f];
    const std::size_t n = row.size();
    if (n > 4) continue;
    for (std::size_t i = 0; i < n; ++i) {
      const Id b0 = row[i], b1 = row[(i + 1) % n];
      if (top_[b0] < 0 || top_[b1] < 0) continue;
      if (row[(i + 2) % n] == top_[b1] && row[n == 4 ? (i + 3) % n : (i + 2) % n] == top_[b0]) {
        sideStart_[f] = static_cast<std::int8_t>(i);
        break;
      }
    }
  }
}

/// Wall faces of a prism, and the lower points around it in the order of the wall; false when the cell is no
/// prism.
bool LayerColumns::findRing(Id cell, std::vector<Id>& roof, std::vector<Id>& ring) const {
  std::vector<std::pair<Id, Id>> steps;
  roof.clear();
  ring.clear();
  if (mesh_.layer[cell] != 1) return false;
  const Id internal = mesh_.internalFaces();
  for (Id f : facesOfCell_[cell]) {
    const Span<Id> row = mesh_.faces[f];
    if (isSide(f)) {
      const auto [b0, b1] = lowerEnds(f);
      steps.push_back(mesh_.owner[f] == cell ? std::make_pair(b0, b1) : std::make_pair(b1, b0));
    } else if (f >= internal && mesh_.isWallPatch(mesh_.patch[f - internal])) {
      roof.push_back(f);
    } else if (std::any_of(row.begin(), row.end(), [&](Id p) { return mesh_.base[p] != kNone; })) {
      return false;
    }
  }
  if (roof.empty() || steps.size() < 3) return false;
  const Id start = std::min_element(steps.begin(), steps.end())->first;
  Id at = start;
  do {
    const auto step = std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s.first == at; });
    if (step == steps.end() || ring.size() == steps.size()) return false;
    ring.push_back(at);
    at = step->second;
  } while (at != start);
  return ring.size() == steps.size() && (roof.size() == 1 || isBelow(roof, ring));
}

/// Is there one lower point of the ring for each point of the roof?
bool LayerColumns::isBelow(const std::vector<Id>& roof, const std::vector<Id>& ring) const {
  const auto below = [&](Id p) {
    return std::count_if(ring.begin(), ring.end(), [&](Id b) { return top_[b] == p; });
  };
  return std::all_of(roof.begin(), roof.end(), [&](Id f) {
    const Span<Id> row = mesh_.faces[f];
    return std::all_of(row.begin(), row.end(), [&](Id p) { return below(p) == 1; });
  });
}

void LayerColumns::findColumns() {
  columnOf_.assign(mesh_.cellCount, kNone);
  std::vector<Id> lower, roof, ring;
  for (Id c = 0; c < mesh_.cellCount; ++c) {
    lower.clear();
    bool whole = true;
    for (Id f : facesOfCell_[c]) {
      forEachPair(mesh_.faces[f], [&](Id p, Id q) {
        if ((mesh_.base[p] == kNone) == (mesh_.base[q] == kNone)) return;
        const Id b = mesh_.base[p] == kNone ? p : q;
        if (top_[b] == kAmbiguous) whole = false;
        lower.push_back(b);
      });
    }
    if (lower.empty()) continue;
    sortUnique(lower);
    columnOf_[c] = count();
    cells_.push_back(c);
    edges_.push(lower);
    if (!whole || !findRing(c, roof, ring)) {
      roof.clear();
      ring.clear();
    }
    roofs_.push(roof);
    rings_.push(ring);
  }
}

void LayerColumns::around(Id column, std::vector<Id>& out) const {
  out.assign(1, column);
  for (Id b : edges_[column]) {
    const Span<Id> columns = edgeColumns_[b];
    out.insert(out.end(), columns.begin(), columns.end());
  }
  sortUnique(out);
}

Id LayerColumns::mostAround(Id lower) const {
  Id most = 1;
  for (Id column : edgeColumns_[lower]) most = std::max(most, layers_[column]);
  return most;
}

void LayerColumns::updateEdges(const std::vector<Id>& changedColumns) {
  for (Id column : changedColumns)
    for (Id b : rings_[column]) edgeLayers_[b] = pinched_[b] ? 1 : mostAround(b);
}

void LayerColumns::pinch(Id lower, bool pinched) {
  pinched_[lower] = pinched;
  edgeLayers_[lower] = pinched ? 1 : mostAround(lower);
}

Id LayerColumns::numberPoints(Id firstId) {
  for (std::size_t b = 0; b < top_.size(); ++b) {
    if (edgeLayers_[b] == 1) continue;
    firstPoint_[b] = firstId;
    firstId += edgeLayers_[b] - 1;
  }
  return firstId;
}

Id LayerColumns::pointAt(Id lower, Id level) const {
  if (level == 0) return top_[lower];
  return level < edgeLayers_[lower] ? firstPoint_[lower] + level - 1 : lower;
}

Id LayerColumns::pieces(Id face) const {
  if (!isSide(face)) return 1;
  const auto [b0, b1] = lowerEnds(face);
  if (pinched_[b0] && pinched_[b1]) return 1;
  const Id own = layersOfCell(mesh_.owner[face]);
  return face < mesh_.internalFaces() ? std::max(own, layersOfCell(mesh_.neighbour[face])) : own;
}

void LayerColumns::pieceRow(Id face, Id piece, std::vector<Id>& row) const {
  row.clear();
  const Span<Id> old = mesh_.faces[face];
  const Id count = pieces(face);
  if (count == 1) {
    forEachPair(old, [&](Id p, Id q) {
      if (top_[q] == p) {
        for (Id level = 1; level < edgeLayers_[q]; ++level) row.push_back(pointAt(q, level));
      } else if (top_[p] == q) {
        for (Id level = edgeLayers_[p] - 1; level > 0; --level) row.push_back(pointAt(p, level));
      }
      row.push_back(q);
    });
    return;
  }
  const auto [b0, b1] = lowerEnds(face);
  // The last piece reaches down to the lower points and holds whatever lies on the edges on the way.
  const auto highest = [&](Id b) { return pinched_[b] ? 0 : piece - 1; };
  const auto lowest = [&](Id b) { return piece == count ? edgeLayers_[b] : pinched_[b] ? 0 : piece; };
  for (Id level = lowest(b1); level >= highest(b1); --level) row.push_back(pointAt(b1, level));
  const bool joined = piece == 1 && top_[b0] == top_[b1];
  for (Id level = joined ? 1 : highest(b0); level <= lowest(b0); ++level) row.push_back(pointAt(b0, level));
}

Id LayerColumns::layerAt(Id cell, Id face, Id piece) const {
  const Id layers = layersOfCell(cell);
  if (layers == 1) return 1;
  if (isSide(face)) {
    const auto [b0, b1] = lowerEnds(face);
    return pinched_[b0] && pinched_[b1] ? layers : std::min(piece, layers);
  }
  const Span<Id> roof = roofs_[columnOf_[cell]];
  return std::find(roof.begin(), roof.end(), face) != roof.end() ? 1 : layers;
}

void LayerColumns::capRow(Id column, Id level, std::vector<Id>& row) const {
  row.clear();
  for (Id b : rings_[column]) row.push_back(pointAt(b, pinched_[b] ? 0 : level));
}

}  // namespace pm
