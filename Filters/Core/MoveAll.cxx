// SPDX-License-Identifier: BSD-3-Clause
// NodeMover's moves of many points at once.
//
// One by one, each move measures the cells around its point, so that every cell is measured for each of its
// points. Here all points go first, and what they touch is measured once; points around what breaks a limit
// go back, half of their way and then all of it. Where all have gone back, all is as it was: so this ends,
// and ends valid.
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <unordered_map>

#include "NodeMover.h"

namespace pm {
namespace {

using Ids = tbb::concurrent_vector<Id>;  // in no order: nothing may depend on it

/// What is to be measured, each once, and why; noted by any thread.
class Noted {
 public:
  explicit Noted(Id slots) : why_(slots) {}
  /// True for the first who notes it for this reason, a bit.
  bool add(Id slot, Id id, std::uint8_t reason) {
    if (has(slot, reason)) return false;
    const std::uint8_t before = why_[slot].fetch_or(reason, std::memory_order_relaxed);
    if (before == 0) ids_.push_back(id);
    return (before & reason) == 0;
  }
  bool has(Id slot, std::uint8_t reason) const {
    return (why_[slot].load(std::memory_order_relaxed) & reason) != 0;
  }
  const Ids& ids() const { return ids_; }
  template <class SlotOf>
  void clear(const SlotOf& slotOf) {
    for (Id id : ids_) why_[slotOf(id)].store(0, std::memory_order_relaxed);
    ids_.clear();
  }

 private:
  std::vector<std::atomic<std::uint8_t>> why_;
  Ids ids_;
};

// A face has a point that moved; a cell has, and so the cell's faces lie otherwise between their cells.
constexpr std::uint8_t kShape = 1, kCell = 2;

}  // namespace

class NodeMover::MoveOfAll {
 public:
  MoveOfAll(NodeMover& mover, const std::vector<Id>& points, std::vector<Vec3> targets)
      : mover_(mover),
        mesh_(mover.mesh_),
        region_(mover.region_),
        points_(points),
        start_(std::move(targets)),
        part_(points.size(), 1),
        indexOf_(region_.points, kNone),
        faces_(region_.faces),
        cells_(region_.cells) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (mover.isMovable(points[i]) && indexOf_[mover.slot(points[i])] == kNone)
        indexOf_[mover.slot(points[i])] = static_cast<Id>(i);
      else
        part_[i] = 0;
  }

  std::vector<float> run() {
    std::vector<Id> going;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (part_[i] > 0) going.push_back(static_cast<Id>(i));
    forEach(going, [&](Id i) { goForth(i); });
    forEach(going, [&](Id i) { touch(points_[i]); });
    noteOutside();
    while (!(going = refused()).empty()) {
      forEach(going, [&](Id i) { goBack(i); });
      forEach(going, [&](Id i) { touch(points_[i]); });
    }
    ++mover_.tick_;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (part_[i] > 0) going.push_back(points_[i]);
    forEach(going, [&](Id p) { noteChange(p); });
    return std::move(part_);
  }

 private:
  /// In blocks, as only this thread may ask whether to stop (AbortError: the mesh is given up then).
  template <class List, class Body>
  void forEach(const List& list, const Body& body) const {
    constexpr std::size_t kBlock = 1 << 18, kGrain = 256;
    for (std::size_t first = 0; first < list.size(); first += kBlock) {
      if (mover_.monitor_ && mover_.monitor_->aborted()) throw AbortError("Stopped on request.");
      const tbb::blocked_range<std::size_t> block(first, std::min(first + kBlock, list.size()), kGrain);
      tbb::parallel_for(block, [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) body(list[i]);
      });
    }
  }

  /// To its target, but for fixed coordinates; what is kept of it from now on is where it started.
  void goForth(Id i) {
    Vec3& point = mesh_.points[points_[i]];
    for (int a = 0; a < 3; ++a)
      if (mesh_.fixed[points_[i]] >> a & 1) start_[i][a] = point[a];
    std::swap(point, start_[i]);
  }
  /// From the end of its way to the middle, from there to its start.
  void goBack(Id i) {
    Vec3& point = mesh_.points[points_[i]];
    part_[i] = part_[i] == 1 ? 0.5f : 0.0f;
    point = part_[i] > 0 ? Vec3(start_[i] + 0.5 * (point - start_[i])) : start_[i];
  }

  void touch(Id p) {
    for (Id f : mover_.facesOf(p)) faces_.add(region_.faceSlot[f], f, kShape);
    for (Id c : mover_.cellsOf(p)) {
      if (!cells_.add(region_.cellSlot[c], c, kCell)) continue;
      for (Id f : mover_.facesOfCell(c)) faces_.add(region_.faceSlot[f], f, kCell);
    }
  }

  /// What is outside a limit before the moves: nothing is measured anew yet.
  void noteOutside() {
    Ids faces, cells;
    forEach(faces_.ids(), [&](Id f) {
      if (mover_.shapeRefuses(f, mover_.face(f), bestShape_) != Refusal::None ||
          mover_.angleRefuses(f, mover_.face(f), bestRelation_) != Refusal::None)
        faces.push_back(f);
    });
    forEach(cells_.ids(), [&](Id c) {
      if (mover_.cellRefuses(mover_.cell(c), bestCell_) != Refusal::None) cells.push_back(c);
    });
    for (Id f : faces) facesBefore_.emplace(f, mover_.face(f));
    for (Id c : cells) cellsBefore_.emplace(c, mover_.cell(c));
  }

  /// Where it was outside a limit; else the best there is, which asks for the limit.
  template <class Map, class State>
  static const State& before(const Map& map, Id id, const State& best) {
    const auto it = map.find(id);
    return it == map.end() ? best : it->second;
  }

  /// Measures what was touched. Places in points_ of those around what breaks a limit that are not where they
  /// started.
  std::vector<Id> refused() {
    Ids shapes, relations, cells;
    forEach(faces_.ids(), [&](Id f) {
      if (!faces_.has(region_.faceSlot[f], kShape)) return;
      Shape& now = mover_.face(f);
      now = mover_.shapeNow(f);
      if (mover_.shapeRefuses(f, now, before(facesBefore_, f, bestShape_)) != Refusal::None)
        shapes.push_back(f);
    });
    forEach(cells_.ids(), [&](Id c) {
      CellState& now = mover_.cell(c);
      now = mover_.cellNow(c);
      if (mover_.cellRefuses(now, before(cellsBefore_, c, bestCell_)) != Refusal::None) cells.push_back(c);
    });
    forEach(faces_.ids(), [&](Id f) {
      Relation& now = mover_.face(f);
      now = mover_.relationNow(f);
      if (mover_.angleRefuses(f, now, before(facesBefore_, f, bestRelation_)) != Refusal::None)
        relations.push_back(f);
    });
    faces_.clear([&](Id f) { return region_.faceSlot[f]; });
    cells_.clear([&](Id c) { return region_.cellSlot[c]; });
    return pointsAround(shapes, relations, cells);
  }

  std::vector<Id> pointsAround(const Ids& shapes, const Ids& relations, const Ids& cells) const {
    std::vector<Id> found;
    const auto addPoints = [&](Span<Id> points) {
      for (Id p : points) {
        const Id i = mover_.isMovable(p) ? indexOf_[mover_.slot(p)] : kNone;
        if (i != kNone && part_[i] > 0) found.push_back(i);
      }
    };
    const auto addCell = [&](Id c) {
      if (region_.isInner(c)) addPoints(mover_.pointsOf(c));
    };
    for (Id f : shapes) addPoints(mesh_.faces[f]);
    for (Id c : cells) addCell(c);
    for (Id f : relations) {
      addCell(mesh_.owner[f]);
      if (mover_.isInternal(f)) addCell(mesh_.neighbour[f]);
    }
    sortUnique(found);
    return found;
  }

  void noteChange(Id p) {
    for (Id c : mover_.cellsOf(p))
      for (Id f : mover_.facesOfCell(c)) mover_.noteChange(f, mover_.tick_);
  }

  NodeMover& mover_;
  PolyMesh& mesh_;
  const MoverRegion& region_;
  const std::vector<Id>& points_;
  std::vector<Vec3> start_;  // #points; the targets until they go there
  std::vector<float> part_;  // #points of its way that a point has gone
  std::vector<Id> indexOf_;  // #slots of points: place in points_, or kNone
  Noted faces_, cells_;
  // What was outside a limit may stay so if it gets no worse.
  const Shape bestShape_ = bestShape();
  const Relation bestRelation_ = bestRelation();
  const CellState bestCell_ = bestCell();
  std::unordered_map<Id, FaceState> facesBefore_;
  std::unordered_map<Id, CellState> cellsBefore_;
};

std::vector<float> NodeMover::moveAll(const std::vector<Id>& points, std::vector<Vec3> targets) {
  return MoveOfAll(*this, points, std::move(targets)).run();
}

}  // namespace pm
