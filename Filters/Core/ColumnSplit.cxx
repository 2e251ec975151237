// SPDX-License-Identifier: BSD-3-Clause
#include "ColumnSplit.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "DisjointSets.h"
#include "WallCuts.h"

namespace pm {

bool hasEdge(Span<Id> row, Id a, Id b) {
  const std::size_t k = std::find(row.begin(), row.end(), a) - row.begin(), n = row.size();
  return k < n && (row[(k + 1) % n] == b || row[(k + n - 1) % n] == b);
}

namespace {

bool has(Span<Id> row, Id p) { return std::find(row.begin(), row.end(), p) != row.end(); }

bool holds(Span<Id> row, const WallPlace& place) {
  return place.isNew() ? hasEdge(row, place.a, place.b) : has(row, place.a);
}

/// The same place at the lower ends of the prism edges; without a point where there are none.
WallPlace below(const PolyMesh& mesh, const WallPlace& place) {
  return {mesh.base[place.a], place.isNew() ? mesh.base[place.b] : kNone};
}

bool hasBelow(const PolyMesh& mesh, const WallPlace& place) {
  return mesh.base[place.a] != kNone &&
         (!place.isNew() || (mesh.base[place.b] != kNone && mesh.base[place.a] != mesh.base[place.b]));
}

/// The only one of a cell's faces for which isIt; kNone when none or several are.
template <class IsIt>
Id onlyFace(const PolyMesh& mesh, Span<Id> faces, const IsIt& isIt) {
  Id found = kNone;
  for (Id f : faces) {
    if (!isIt(mesh.faces[f])) continue;
    if (found != kNone) return kNone;
    found = f;
  }
  return found;
}

/// The face under a cell's wall face that holds both lower places.
Id lowerFace(const PolyMesh& mesh, Span<Id> faces, const WallPlace& x, const WallPlace& y) {
  return onlyFace(mesh, faces, [&](Span<Id> row) {
    return holds(row, x) && holds(row, y) &&
           std::none_of(row.begin(), row.end(), [&](Id p) { return mesh.base[p] != kNone; });
  });
}

/// The quad below a wall edge.
Id sideFace(const PolyMesh& mesh, Span<Id> faces, const WallPlace& edge) {
  const WallPlace low = below(mesh, edge);
  const Id f = onlyFace(mesh, faces, [&](Span<Id> row) {
    return row.size() == 4 && hasEdge(row, edge.a, edge.b) && hasEdge(row, low.a, low.b);
  });
  return f < mesh.internalFaces() ? f : kNone;
}

/// Would a cut between the two places of a face leave two faces?
bool parts(Span<Id> row, const WallPlace& x, const WallPlace& y) {
  if (!x.isNew() && !y.isNew()) return x.a != y.a && !hasEdge(row, x.a, y.a);
  if (x.isNew() && y.isNew()) return std::minmax(x.a, x.b) != std::minmax(y.a, y.b);
  const WallPlace &edge = x.isNew() ? x : y, &point = x.isNew() ? y : x;
  return point.a != edge.a && point.a != edge.b;
}

/// All that changes, and the mesh made anew from it.
class Splitter {
 public:
  Splitter(PolyMesh& mesh, const Csr<Id>& facesOfCell)
      : mesh_(mesh),
        facesOfCell_(facesOfCell),
        touched_(mesh.points.size(), 0),
        isHalved_(mesh.cellCount, 0),
        isCut_(mesh.faceCount(), 0) {}

  void plan(const WallPath& path) {
    std::vector<Id> top, low;
    for (const WallPlace& place : path.places) {
      top.push_back(place.isNew() ? addPoint(place) : place.a);
      low.push_back(place.isNew() ? addPoint(below(mesh_, place)) : mesh_.base[place.a]);
      if (place.isNew()) mesh_.base[top.back()] = low.back();
    }
    for (std::size_t i = 0; i < path.faces.size(); ++i) {
      const WallPlace& x = path.places[i];
      const Id cell = mesh_.owner[path.faces[i]];
      const Span<Id> faces = facesOfCell_[cell];
      if (x.isNew()) cuts_.push_back({sideFace(mesh_, faces, x), top[i], low[i]});
      if (path.isEdge()) return;
      const WallPlace& y = path.places[i + 1];
      cuts_.push_back({path.faces[i], top[i], top[i + 1]});
      cuts_.push_back({lowerFace(mesh_, faces, below(mesh_, x), below(mesh_, y)), low[i], low[i + 1]});
      isHalved_[cell] = 1;
      halves_.push_back({cell, {top[i], top[i + 1], low[i + 1], low[i]}, {}});
    }
  }

  void apply() {
    const auto byFace = [](const WallCut& x, const WallCut& y) { return x.face < y.face; };
    std::sort(cuts_.begin(), cuts_.end(), byFace);
    std::sort(halves_.begin(), halves_.end(), [](const auto& x, const auto& y) { return x.cell < y.cell; });
    const std::vector<Id> patch = std::exchange(mesh_.patch, {});
    old_ = std::exchange(mesh_.faces, {});
    oldOwner_ = std::exchange(mesh_.owner, {});
    const std::vector<Id> neighbour = std::exchange(mesh_.neighbour, {});
    const Id internal = static_cast<Id>(neighbour.size());
    for (const WallCut& c : cuts_) isCut_[c.face] = 1;
    reserve();
    for (Id f = 0; f < internal; ++f) addPieces(f, neighbour[f]);
    for (Half& half : halves_) addSide(half);
    for (Id f = internal; f < old_.rows(); ++f)
      for (Id n = addPieces(f, kNone); n-- > 0;) mesh_.patch.push_back(patch[f - internal]);
    for (Half& half : halves_) divide(half);
    for (Id f = 0; f < mesh_.internalFaces(); ++f)
      if (mesh_.owner[f] > mesh_.neighbour[f]) turn(f);
  }

 private:
  struct Half {
    Id cell;
    std::array<Id, 4> side;  // of the face between the two: wall, wall, low, low
    std::vector<Id> faces;   // of the cell, without that face
    Id face = kNone;         // between the two
  };
  using Edge = std::pair<Id, Id>;

  /// Paths that cross the same edge share its new point.
  Id addPoint(const WallPlace& edge) {
    const Id id = static_cast<Id>(mesh_.points.size());
    const auto [at, isFirst] = middles_.emplace(std::minmax(edge.a, edge.b), id);
    if (!isFirst) return at->second;
    mesh_.points.push_back(0.5 * (mesh_.points[edge.a] + mesh_.points[edge.b]));
    mesh_.base.push_back(kNone);
    if (!mesh_.fixed.empty()) mesh_.fixed.push_back(mesh_.fixed[edge.a] & mesh_.fixed[edge.b]);
    touched_.push_back(0);
    touched_[edge.a] = touched_[edge.b] = 1;
    return id;
  }

  /// A face's points with the new ones on its edges.
  void widen(Span<Id> row, std::vector<Id>& out) const {
    out.clear();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Id p = row[k], q = row[(k + 1) % row.size()];
      out.push_back(p);
      if (!touched_[p] || !touched_[q]) continue;
      const auto it = middles_.find(std::minmax(p, q));
      if (it != middles_.end()) out.push_back(it->second);
    }
  }

  void reserve() {
    const std::size_t faces = old_.rows() + cuts_.size() + halves_.size();
    mesh_.faces.offsets.reserve(faces + 1);
    mesh_.faces.values.reserve(old_.values.size() + 6 * (cuts_.size() + halves_.size()));
    mesh_.owner.reserve(faces);
    mesh_.neighbour.reserve(faces);
  }

  /// What becomes of an old face; returns how many.
  Id addPieces(Id f, Id neighbour) {
    const Span<Id> row = old_[f];
    if (std::none_of(row.begin(), row.end(), [&](Id p) { return touched_[p] != 0; })) {
      if (!isCut_[f]) return add(row, oldOwner_[f], neighbour), 1;
    }
    widen(row, wide_);
    if (!isCut_[f]) return add(spanOf(wide_), oldOwner_[f], neighbour), 1;
    const auto cut = std::lower_bound(cuts_.begin(), cuts_.end(), f,
                                      [](const WallCut& c, Id face) { return c.face < face; });
    cutRow(spanOf(wide_), cut->a, cut->b, first_, second_);
    add(spanOf(first_), oldOwner_[f], neighbour);
    add(spanOf(second_), oldOwner_[f], neighbour);
    return 2;
  }

  void add(Span<Id> row, Id owner, Id neighbour) {
    const Id f = mesh_.faces.rows();
    mesh_.faces.push(row);
    mesh_.owner.push_back(owner);
    if (neighbour != kNone) mesh_.neighbour.push_back(neighbour);
    for (Id cell : {owner, neighbour})
      if (Half* half = halfOf(cell)) half->faces.push_back(f);
  }

  Half* halfOf(Id cell) {
    if (cell == kNone || cell >= static_cast<Id>(isHalved_.size()) || !isHalved_[cell]) return nullptr;
    const auto it = std::lower_bound(halves_.begin(), halves_.end(), cell,
                                     [](const Half& h, Id c) { return h.cell < c; });
    return &*it;
  }

  void addSide(Half& half) {
    half.face = mesh_.faces.rows();
    mesh_.faces.push(half.side);
    mesh_.owner.push_back(half.cell);
    mesh_.neighbour.push_back(mesh_.cellCount++);
    mesh_.level.push_back(mesh_.level[half.cell]);
    mesh_.layer.push_back(mesh_.layer[half.cell]);
    if (!mesh_.zone.empty()) mesh_.zone.push_back(mesh_.zone[half.cell]);
  }

  /// Gives the cell's faces beyond the new side to the new cell: those that hang together by edges that are
  /// none of the side's, and do not hold the side's first edge as the cell's own would.
  void divide(Half& half) {
    const Id other = mesh_.neighbour[half.face];
    const Span<Id> side = mesh_.faces[half.face];
    const std::size_t count = half.faces.size();
    DisjointSets parts(count);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (hang(half.faces[i], half.faces[j], side)) parts.join(static_cast<Id>(i), static_cast<Id>(j));
    // Outwards, a face of the old cell runs along the side's first edge the other way.
    for (std::size_t i = 0; i < count; ++i) {
      if (!runs(half.faces[i], half.cell, side[0], side[1])) continue;
      for (std::size_t j = 0; j < count; ++j) {
        if (parts.root(static_cast<Id>(j)) != parts.root(static_cast<Id>(i))) continue;
        const Id f = half.faces[j];
        (mesh_.owner[f] == half.cell ? mesh_.owner[f] : mesh_.neighbour[f]) = other;
      }
      return;
    }
  }

  /// Do two faces share an edge that is none of the side's?
  bool hang(Id f, Id g, Span<Id> side) const {
    const Span<Id> x = mesh_.faces[f], y = mesh_.faces[g];
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Id p = x[k], q = x[(k + 1) % x.size()];
      if (hasEdge(y, p, q) && !hasEdge(side, p, q)) return true;
    }
    return false;
  }

  /// Does the face, seen from outside the cell, run from p to q?
  bool runs(Id f, Id cell, Id p, Id q) const {
    const Span<Id> row = mesh_.faces[f];
    if (mesh_.owner[f] != cell) std::swap(p, q);
    const std::size_t k = std::find(row.begin(), row.end(), p) - row.begin();
    return k < row.size() && row[(k + 1) % row.size()] == q;
  }

  void turn(Id f) {
    std::swap(mesh_.owner[f], mesh_.neighbour[f]);
    std::reverse(mesh_.faces.values.begin() + mesh_.faces.offsets[f],
                 mesh_.faces.values.begin() + mesh_.faces.offsets[f + 1]);
  }

  PolyMesh& mesh_;
  const Csr<Id>& facesOfCell_;
  std::vector<char> touched_;   // #P end of an edge with a new point
  std::vector<WallCut> cuts_;   // of faces of any kind
  std::map<Edge, Id> middles_;  // new points of edges
  std::vector<Half> halves_;
  std::vector<char> isHalved_, isCut_;  // #C, #F
  Csr<Id> old_;
  std::vector<Id> oldOwner_, wide_, first_, second_;
};

}  // namespace

WallPath pathIn(const SubMesh& part, WallPath path) {
  for (WallPlace& place : path.places) place = {part.pointOf(place.a), part.pointOf(place.b)};
  for (Id& f : path.faces) f = part.boundaryFaceOf(f);
  return path;
}

bool canSplitColumns(const PolyMesh& mesh, const Csr<Id>& facesOfCell, const WallPath& path) {
  if (path.isEdge()) {
    const WallPlace& edge = path.places[0];
    return edge.isNew() && hasBelow(mesh, edge) &&
           sideFace(mesh, facesOfCell[mesh.owner[path.faces[0]]], edge) != kNone;
  }
  std::vector<Id> cells;
  for (std::size_t i = 0; i < path.faces.size(); ++i) {
    const WallPlace &x = path.places[i], &y = path.places[i + 1];
    const Id cell = mesh.owner[path.faces[i]];
    const Span<Id> faces = facesOfCell[cell];
    cells.push_back(cell);
    if (!hasBelow(mesh, x) || !hasBelow(mesh, y) || !parts(mesh.faces[path.faces[i]], x, y)) return false;
    const WallPlace lowX = below(mesh, x), lowY = below(mesh, y);
    const Id low = lowerFace(mesh, faces, lowX, lowY);
    if (low == kNone || !parts(mesh.faces[low], lowX, lowY)) return false;
    for (const WallPlace& place : {x, y})
      if (place.isNew() && sideFace(mesh, faces, place) == kNone) return false;
  }
  const std::size_t count = cells.size();
  sortUnique(cells);
  return count > 0 && cells.size() == count;
}

void splitColumns(PolyMesh& mesh, const Csr<Id>& facesOfCell, const std::vector<WallPath>& paths) {
  if (paths.empty()) return;
  Splitter splitter(mesh, facesOfCell);
  for (const WallPath& path : paths) splitter.plan(path);
  splitter.apply();
}

}  // namespace pm
