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
#include <numeric>
#include <unordered_map>

#include "MoverMeasures.h"
#include "NodeMover.h"

namespace pm {
namespace {

/// Of its way, what a point keeps when it goes back.
double partBehind(double part) { return part == 1 ? 0.5 : 0.0; }

/// What is to be measured, and then what was found to break a limit; written by any thread.
class Marks {
 public:
  explicit Marks(Id slots) : marks_(slots) {}
  void add(Id slot) { marks_[slot].store(kToMeasure, std::memory_order_relaxed); }
  bool has(Id slot) const { return marks_[slot].load(std::memory_order_relaxed) == kToMeasure; }
  /// Measures what is marked, and keeps the mark of what is refused.
  template <class Measure>
  void visit(Id slot, const Measure& measure) {
    if (has(slot) && measure() == Refusal::None) marks_[slot].store(0, std::memory_order_relaxed);
  }
  /// Takes the mark away.
  bool take(Id slot) {
    const bool marked = has(slot);
    if (marked) marks_[slot].store(0, std::memory_order_relaxed);
    return marked;
  }

 private:
  static constexpr std::uint8_t kToMeasure = 1;
  std::vector<std::atomic<std::uint8_t>> marks_;
};

}  // namespace

class NodeMover::MoveOfAll {
 public:
  MoveOfAll(NodeMover& mover, const std::vector<Id>& points, const std::vector<Vec3>& targets)
      : mover_(mover),
        mesh_(mover.mesh_),
        region_(mover.region_),
        points_(points),
        targets_(targets),
        part_(points.size(), 1.0),
        indexOf_(region_.points, kNone),
        shapes_(region_.faces),
        relations_(region_.faces),
        cells_(region_.cells) {
    start_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      start_.push_back(mesh_.points[points[i]]);
      if (mover.isMovable(points[i]))
        indexOf_[mover.slot(points[i])] = static_cast<Id>(i);
      else
        part_[i] = 0;
    }
    noteOutside();
  }

  std::vector<double> run() {
    std::vector<Id> going(points_.size());
    std::iota(going.begin(), going.end(), 0);
    while (!going.empty()) {
      forEach(static_cast<Id>(going.size()), [&](Id k) { place(going[k]); });
      forEach(static_cast<Id>(going.size()), [&](Id k) { mark(points_[going[k]]); });
      measure();
      going = refused();
      for (Id i : going) part_[i] = partBehind(part_[i]);
    }
    ++mover_.tick_;
    forEach(static_cast<Id>(points_.size()), [&](Id i) {
      if (part_[i] > 0) noteChange(points_[i]);
    });
    return std::move(part_);
  }

 private:
  /// In blocks, as only this thread may ask whether to stop (AbortError: the mesh is given up then).
  template <class Body>
  void forEach(Id count, const Body& body) {
    constexpr Id kBlock = 1 << 18, kGrain = 512;
    for (Id first = 0; first < count; first += std::min(kBlock, count - first)) {
      if (mover_.monitor_ && mover_.monitor_->aborted()) throw AbortError("Stopped on request.");
      const tbb::blocked_range<Id> block(first, first + std::min(kBlock, count - first), kGrain);
      tbb::parallel_for(block, [&](const auto& range) {
        for (Id i = range.begin(); i < range.end(); ++i) body(i);
      });
    }
  }
  /// Faces that are measured, and cells of movable points; body(id, slot).
  template <class Body>
  void forEachFace(const Body& body) {
    forEach(mesh_.faceCount(), [&](Id f) {
      if (region_.faceSlot[f] != kNone) body(f, region_.faceSlot[f]);
    });
  }
  template <class Body>
  void forEachCell(const Body& body) {
    forEach(mesh_.cellCount, [&](Id c) {
      if (region_.isInner(c)) body(c, region_.cellSlot[c]);
    });
  }

  void noteOutside() {
    tbb::concurrent_vector<Id> faces, cells;
    forEachFace([&](Id f, Id) {
      if (mover_.shapeRefuses(f, mover_.face(f), bestShape_) != Refusal::None ||
          mover_.angleRefuses(f, mover_.face(f), bestRelation_) != Refusal::None)
        faces.push_back(f);
    });
    forEachCell([&](Id c, Id) {
      if (mover_.cellRefuses(mover_.cell(c), bestCell_) != Refusal::None) cells.push_back(c);
    });
    for (Id f : faces) facesBefore_.emplace(f, mover_.face(f));
    for (Id c : cells) cellsBefore_.emplace(c, mover_.cell(c));
  }

  /// To the part of its way that a point may go; at its end and at its start to the bit.
  void place(Id i) {
    const Id p = points_[i];
    const Vec3 to = part_[i] == 1 ? targets_[i] : Vec3(start_[i] + part_[i] * (targets_[i] - start_[i]));
    for (int a = 0; a < 3; ++a)
      if (!(mesh_.fixed[p] >> a & 1)) mesh_.points[p][a] = part_[i] == 0 ? start_[i][a] : to[a];
  }

  void mark(Id p) {
    for (Id f : mover_.facesOf(p)) shapes_.add(region_.faceSlot[f]);
    for (Id c : mover_.cellsOf(p)) {
      const Id slot = region_.cellSlot[c];
      if (cells_.has(slot)) continue;
      cells_.add(slot);
      for (Id f : region_.cellFaces[slot]) relations_.add(region_.faceSlot[f]);
    }
  }

  template <class Part>
  const Part& faceBefore(Id f, const Part& best) const {
    const auto before = facesBefore_.find(f);
    return before == facesBefore_.end() ? best : before->second;
  }

  void measure() {
    forEachFace([&](Id f, Id slot) {
      shapes_.visit(slot, [&] {
        Shape& now = mover_.face(f);
        now = mover_.shapeNow(f);
        return mover_.shapeRefuses(f, now, faceBefore<Shape>(f, bestShape_));
      });
    });
    forEachCell([&](Id c, Id slot) {
      cells_.visit(slot, [&] {
        CellState& now = mover_.cell(c);
        now = mover_.cellNow(c);
        const auto before = cellsBefore_.find(c);
        return mover_.cellRefuses(now, before == cellsBefore_.end() ? bestCell_ : before->second);
      });
    });
    forEachFace([&](Id f, Id slot) {
      relations_.visit(slot, [&] {
        Relation& now = mover_.face(f);
        now = mover_.relationNow(f);
        return mover_.angleRefuses(f, now, faceBefore<Relation>(f, bestRelation_));
      });
    });
  }

  /// Places in points_ of those that are not where they started, around what breaks a limit.
  std::vector<Id> refused() {
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
    for (Id f = 0; f < mesh_.faceCount(); ++f) {
      const Id slot = region_.faceSlot[f];
      if (slot == kNone) continue;
      if (shapes_.take(slot)) addPoints(mesh_.faces[f]);
      if (!relations_.take(slot)) continue;
      addCell(mesh_.owner[f]);
      if (mover_.isInternal(f)) addCell(mesh_.neighbour[f]);
    }
    for (Id c = 0; c < mesh_.cellCount; ++c)
      if (region_.isInner(c) && cells_.take(region_.cellSlot[c])) addCell(c);
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
  const std::vector<Vec3>& targets_;
  std::vector<Vec3> start_;   // #points
  std::vector<double> part_;  // #points of its way that a point has gone
  std::vector<Id> indexOf_;   // #slots of points: place in points_, or kNone
  Marks shapes_, relations_, cells_;
  const Shape bestShape_ = bestShape();
  const Relation bestRelation_ = bestRelation();
  const CellState bestCell_ = bestCell();
  // What is outside a limit before the moves, and may stay so if it gets no worse.
  std::unordered_map<Id, FaceState> facesBefore_;
  std::unordered_map<Id, CellState> cellsBefore_;
};

std::vector<double> NodeMover::moveAll(const std::vector<Id>& points, const std::vector<Vec3>& targets) {
  return MoveOfAll(*this, points, targets).run();
}

}  // namespace pm
