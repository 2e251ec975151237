// SPDX-License-Identifier: BSD-3-Clause
// NodeMover's hypothetical questions: several moves on trial, and a face that is to be cut.
#include <limits>
#include <unordered_set>

#include "MoverMeasures.h"
#include "NodeMover.h"

namespace pm {

NodeMover::Trial::Trial(NodeMover& mover) : mover_(mover) { trial_ = this; }

NodeMover::Trial::~Trial() {
  trial_ = nullptr;
  for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry)
    mover_.undo(entry->points.data(), entry->touched);
}

void NodeMover::Trial::force(const std::vector<Id>& points, const std::vector<Vec3>& targets) {
  Touched t;
  for (Id p : points) {
    if (!mover_.isMovable(p)) return;
    t.oldPoints.push_back(mover_.mesh_.points[p]);
  }
  mover_.place(points.data(), targets.data(), t);
  mover_.gather(points.data(), points.size(), t);
  mover_.remeasure(t);
  mover_.keep(points.data(), t);
}

bool NodeMover::Trial::settle() {
  if (!holds()) return false;
  entries_.clear();
  return true;
}

/// What an entry is the first to touch was then as before the trial.
bool NodeMover::Trial::holds() const {
  std::unordered_set<Id> shapes, cells, faces;
  for (const Entry& entry : entries_) {
    const Touched& t = entry.touched;
    for (std::size_t i = 0; i < t.shapes.size(); ++i) {
      const Id f = t.shapes[i];
      if (shapes.insert(f).second && mover_.shapeRefuses(f, mover_.face(f), t.oldShapes[i]) != Refusal::None)
        return false;
    }
    for (std::size_t i = 0; i < t.cells.size(); ++i) {
      const Id c = t.cells[i];
      if (cells.insert(c).second && mover_.cellRefuses(mover_.cell(c), t.oldCells[i]) != Refusal::None)
        return false;
    }
    for (std::size_t i = 0; i < t.faces.size(); ++i) {
      const Id f = t.faces[i];
      if (faces.insert(f).second &&
          mover_.angleRefuses(f, mover_.face(f), t.oldRelations[i]) != Refusal::None)
        return false;
    }
  }
  return true;
}

void NodeMover::remeasure(Touched& t) {
  for (Id f : t.shapes) {
    t.oldShapes.push_back(face(f));
    static_cast<Shape&>(face(f)) = shapeNow(f);
  }
  for (Id c : t.cells) {
    t.oldCells.push_back(cell(c));
    cell(c) = cellNow(c);
  }
  gatherFaces(t);
  for (Id f : t.faces) {
    t.oldRelations.push_back(face(f));
    static_cast<Relation&>(face(f)) = relationNow(f);
  }
}

/// The cell behind wall faces that are exchanged for others.
NodeMover::CellState NodeMover::cellWith(Id c, const Exchange& exchange) const {
  std::vector<CellFace> faces;
  for (Id f : facesOfCell(c)) {
    const FaceState& s = this->face(f);
    if (!exchange.takesOut(f))
      faces.push_back({mesh_.faces[f], &s.centre, &s.normal, mesh_.owner[f] == c ? 1.0 : -1.0});
  }
  for (std::size_t i = 0; i < exchange.rows.size(); ++i)
    faces.push_back({exchange.row(i), &exchange.shapes[i].centre, &exchange.shapes[i].normal, 1.0});
  CellState state;
  static_cast<CellMeasures&>(state) =
      measureCell(mesh_.points, pointsOf(c), {faces.data(), faces.data() + faces.size()});
  state.determinant = cell(c).determinant;  // of its internal faces, which stay
  return state;
}

// What no measure is better than: a limit is then asked for whatever was before.
NodeMover::Shape NodeMover::bestShape() {
  constexpr float most = std::numeric_limits<float>::max();
  Shape best;
  best.eta = best.cosWarpage = most;
  return best;
}

NodeMover::Relation NodeMover::bestRelation() {
  constexpr float most = std::numeric_limits<float>::max();
  return {most, -most, most, most, most};
}

NodeMover::CellState NodeMover::bestCell() {
  CellState best;
  best.volume = best.minTet = best.minPyramid = best.determinant = std::numeric_limits<double>::max();
  return best;
}

bool NodeMover::holdsWith(Exchange& exchange) const {
  const Id old = exchange.gone.front(), c = mesh_.owner[old];
  if (!region_.isInner(c)) return false;
  for (std::size_t i = 0; i < exchange.rows.size(); ++i) {
    exchange.shapes.push_back(shapeOf(old, exchange.row(i)));
    if (shapeRefuses(old, exchange.shapes[i], bestShape()) != Refusal::None) return false;
  }
  const CellState state = cellWith(c, exchange);
  if (cellRefuses(state, cell(c)) != Refusal::None) return false;
  for (std::size_t i = 0; i < exchange.rows.size(); ++i) {
    const Relation now = relationOf(old, exchange.row(i), exchange.shapes[i], state, nullptr);
    if (angleRefuses(old, now, bestRelation()) != Refusal::None) return false;
  }
  for (Id f : facesOfCell(c)) {
    if (exchange.takesOut(f)) continue;
    const bool owns = mesh_.owner[f] == c;
    const CellMeasures* other = owns ? (isInternal(f) ? &cell(mesh_.neighbour[f]) : nullptr) : &state;
    const CellMeasures& own = owns ? static_cast<const CellMeasures&>(state) : cell(mesh_.owner[f]);
    const Relation now = relationOf(f, mesh_.faces[f], face(f), own, other);
    if (angleRefuses(f, now, face(f)) != Refusal::None) return false;
  }
  return true;
}

bool NodeMover::holdsAround(Id p) const {
  const CellState best = bestCell();
  for (Id c : cellsOf(p)) {
    if (cellRefuses(cell(c), best) != Refusal::None) return false;
    if (region_.isRim(c)) continue;
    for (Id f : facesOfCell(c))
      if (shapeRefuses(f, face(f), bestShape()) != Refusal::None ||
          angleRefuses(f, face(f), bestRelation()) != Refusal::None)
        return false;
  }
  return true;
}

bool NodeMover::cutHolds(const WallCut& cut) const {
  Exchange exchange;
  exchange.gone = {cut.face};
  exchange.rows.resize(2);
  cutRow(mesh_.faces[cut.face], cut.a, cut.b, exchange.rows[0], exchange.rows[1]);
  return holdsWith(exchange);
}

bool NodeMover::mergeHolds(const WallMerge& merge) const {
  Exchange exchange;
  exchange.gone = {merge.first, merge.second};
  exchange.rows = {mergedRow(mesh_.faces[merge.first], mesh_.faces[merge.second], merge.a, merge.b)};
  return holdsWith(exchange);
}

}  // namespace pm
