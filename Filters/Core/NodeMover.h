// SPDX-License-Identifier: BSD-3-Clause
// Node drifting (thesis 4.4.1): a point moves only if every cell and face it touches keeps the limits.
//
// The mover caches measures of what moves can touch and keeps them current move by move; an undone move
// restores points and caches to the bit. What a move touches: the cells around the point and all their faces.
// Where a face or cell is outside a limit already, a move may not make it worse.
//
// Named the points that may move, the mover caches their cells and the faces of those (some 80 bytes each,
// and as much for the cells on the rim), and refuses to move any other point.
//
// What only compares a face with its limits is kept in single precision, rounded to the side of the limit
// where it is.
//
// The mover also notes when something last moved around each point, so that callers need not try again what
// cannot end differently: an attempt depends on its targets and on what lastChange() covers, nothing else.
#pragma once

#include <tbb/parallel_for.h>
#include <algorithm>

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "MeshQuality.h"
#include "MoveGroups.h"
#include "WallCuts.h"

namespace pm {

/// What refuses a move: the first limit found broken, or Other, when the caller does not want it.
enum class Refusal : std::uint8_t {
  None,
  Eta,
  Warpage,
  Volume,
  CentralTet,
  FacePyramid,
  Determinant,
  Angle,
  Skewness,
  FaceWeight,
  VolumeRatio,
  FaceTet,
  NotMovable,  ///< the point is not among those the mover was given
  Other
};
/// In words, e.g. "warpage of a face".
const char* describe(Refusal refusal);

class NodeMover {
 public:
  /// Points move in place. The topology must not change while the mover lives, but for what
  /// wallFacesChanged() is told of.
  /// A monitor makes forEach() stop soon after an abort.
  NodeMover(PolyMesh& mesh, const QualityLimits& limits, const Monitor* monitor = nullptr)
      : NodeMover(mesh, limits, MoverRegion(mesh, nullptr), monitor) {}
  /// The same for these points only, in any order; others cannot move, and have neither cells nor measures.
  NodeMover(PolyMesh& mesh, const QualityLimits& limits, const std::vector<Id>& movable,
            const Monitor* monitor = nullptr)
      : NodeMover(mesh, limits, MoverRegion(mesh, &movable), monitor) {}

  /// Wall faces of these cells have been cut or merged (see WallCuts).
  void wallFacesChanged(const std::vector<Id>& cells);

  /// Moves p to target (its fixed coordinates stay); true when kept.
  bool move(Id p, const Vec3& target) { return tryMove(p, target) == Refusal::None; }
  /// The same, and says why not; None when kept.
  Refusal tryMove(Id p, const Vec3& target) { return attempt(&p, &target, 1, kAny); }
  /// As move, but kept only if accept() agrees. It is asked while the point is there and the shapes of its
  /// faces are current, before the costly checks.
  template <class Accept>
  bool moveIf(Id p, const Vec3& target, const Accept& accept) {
    return attempt(&p, &target, 1, kAny, std::cref(accept)) == Refusal::None;
  }
  /// As move, but a refused target is pulled back half way, up to `halvings` times. Returns the kept fraction
  /// of the way, 0 when the point stayed.
  double drift(Id p, const Vec3& target, int halvings = 3);
  /// Kept only if valid and the worst local measure, relative to its limit, gets better (4.5, second
  /// strategy).
  bool improve(Id p, const Vec3& target) { return improve(p, target, badness(p)); }
  /// The same where badness(p) is known, as when several places are tried.
  bool improve(Id p, const Vec3& target, double badness) {
    return attempt(&p, &target, 1, badness) == Refusal::None;
  }
  /// The same, and only if accept() agrees; see moveIf().
  template <class Accept>
  bool improveIf(Id p, const Vec3& target, double badness, const Accept& accept) {
    return attempt(&p, &target, 1, badness, std::cref(accept)) == Refusal::None;
  }
  /// Moves several points at once, all or none.
  bool moveTogether(const std::vector<Id>& points, const std::vector<Vec3>& targets) {
    return attempt(points.data(), targets.data(), points.size(), kAny) == Refusal::None;
  }
  template <std::size_t N>
  bool moveTogether(const Id (&points)[N], const Vec3 (&targets)[N]) {
    return attempt(points, targets, N, kAny) == Refusal::None;
  }
  /// The same, and only if accept() agrees; see moveIf().
  template <std::size_t N, class Accept>
  bool moveTogetherIf(const Id (&points)[N], const Vec3 (&targets)[N], const Accept& accept) {
    return attempt(points, targets, N, kAny, std::cref(accept)) == Refusal::None;
  }
  bool improveTogether(const std::vector<Id>& points, const std::vector<Vec3>& targets);
  /// Moves many points at once, in parallel (of a point named twice only the first counts); where that breaks
  /// a limit, those around go back, half of their way or all of it. Returns the part of its way that each
  /// point has gone: 1, 0.5 or 0. Costs a fifth of moving them one by one, and keeps fewer: a point goes back
  /// for what its neighbours break.
  std::vector<float> moveAll(const std::vector<Id>& points, std::vector<Vec3> targets);
  /// Are all measures around p within the limits?
  bool holdsAround(Id p) const;
  /// Would the limits hold if a wall face of a movable point were cut from one of its points to another? What
  /// is outside a limit already may not get worse. Thread-safe.
  bool cutHolds(const WallCut& cut) const;
  /// The same for two wall faces merged into one.
  bool mergeHolds(const WallMerge& merge) const;

  /// Moves of one thread that are kept or put back as a whole (drifting with local optimisation, 4.4.1): the
  /// first is forced whatever it breaks, improve() at other points mends what it can, and settle() keeps all
  /// if in the end no limit is broken that was not, and what was outside a limit is no worse.
  class Trial {
   public:
    explicit Trial(NodeMover& mover);
    ~Trial();  ///< puts everything back, to the bit, unless settled
    Trial(const Trial&) = delete;
    Trial& operator=(const Trial&) = delete;
    void force(const std::vector<Id>& points, const std::vector<Vec3>& targets);
    bool settle();

   private:
    friend class NodeMover;
    struct Entry;
    bool holds() const;
    NodeMover& mover_;
    std::vector<Entry> entries_;  // kept moves, in their order
  };

  /// Worst measure that moves of a point can change, relative to its limit: below 1 is valid, above 1 is not.
  /// The shapes of faces across its cells are not among them.
  double badness(Id p) const;

  /// Groups of points whose moves (a wall point's together with its base) touch nothing in common: within a
  /// group they may run in parallel, with the same result for any number of threads. Greedy, in the order
  /// given.
  std::vector<std::vector<Id>> colour(const std::vector<Id>& points) const;
  /// The same for rows of points that move in turn.
  std::vector<std::vector<Id>> colourRows(const Csr<Id>& rows) const {
    return groupRows(mesh_, region_, rows);
  }
  /// The same for sweeps over many points: neighbours move one after the other, in blocks, which is kinder to
  /// the caches.
  MoveBlocks blocks(const std::vector<Id>& points) const { return groupBlocks(mesh_, region_, points); }
  /// Calls body(point) for every point, group by group, the points (or blocks) of a group in parallel. Throws
  /// AbortError between groups when the monitor says so.
  template <class Body>
  void forEach(const std::vector<std::vector<Id>>& groups, const Body& body);
  template <class Body>
  void forEach(const MoveBlocks& blocks, const Body& body);

  /// The time of a move or of an attempt: later for what comes later in forEach(), unless the two touch
  /// nothing in common.
  Id tick() const { return now_ > 0 ? now_ : tick_; }
  /// When something last moved that the measures around p and, for a wall point, around its base depend on.
  /// What failed at a later tick fails again.
  Id lastChange(Id p) const;
  /// False when nothing around the point has moved since the attempt that `tried` remembers: another would
  /// end as that one. Notes an attempt otherwise; 0 is none yet.
  bool worthTrying(Id p, Id& tried) const {
    if (lastChange(p) < tried) return false;
    tried = tick();
    return true;
  }

  const PolyMesh& mesh() const { return mesh_; }
  const QualityLimits& limits() const { return limits_; }
  const Vec3& point(Id p) const { return mesh_.points[p]; }
  /// Of a movable point, else none.
  Span<Id> cellsOf(Id p) const { return isMovable(p) ? region_.pointCells[slot(p)] : Span<Id>(); }
  Span<Id> facesOfCell(Id c) const { return region_.cellFaces[region_.cellSlot[c]]; }
  Span<Id> facesOf(Id p) const { return isMovable(p) ? region_.pointFaces[slot(p)] : Span<Id>(); }
  /// Of a cell of a movable point; the same for the faces and cells below.
  Span<Id> pointsOf(Id cell) const { return region_.cellPoints[region_.cellSlot[cell]]; }
  bool isMovable(Id p) const { return slot(p) != kNone; }
  const Vec3& faceCentre(Id f) const { return face(f).centre; }
  const Vec3& faceNormal(Id f) const { return face(f).normal; }  ///< length = area, leaves the owner
  /// Sum of the faces' area vectors; of the wall faces around a node, its outward direction there.
  Vec3 areaVector(Span<Id> faces) const {
    Vec3 sum = Vec3::Zero();
    for (Id f : faces) sum += face(f).normal;
    return sum;
  }
  /// Unit mean of the faces' unit normals, each face alike; zero where they cancel.
  Vec3 meanNormal(Span<Id> faces) const {
    Vec3 sum = Vec3::Zero();
    for (Id f : faces) sum += face(f).normal.normalized();
    const double length = sum.norm();
    return length > 0 ? Vec3(sum / length) : Vec3(Vec3::Zero());
  }
  /// Mean of the points next to a movable point on its faces.
  Vec3 neighbourMean(Id p) const;
  const Vec3& cellCentre(Id c) const { return cell(c).centre; }

 private:
  struct Shape {
    Vec3 centre, normal;
    float eta, cosWarpage;
  };
  /// What lies between a face and its cells.
  struct Relation {
    float cosAngle = 1;  ///< the worse of the thesis' and of OpenFOAM's cell centres
    float skew = 0, weight = 0.5, volumeRatio = 1, tet = 0;  ///< tet: smallest of OpenFOAM's decomposition
  };
  struct FaceState : Shape, Relation {};
  /// Wall faces of a cell that are to take the place of others.
  struct Exchange {
    std::vector<Id> gone;
    std::vector<std::vector<Id>> rows;
    std::vector<Shape> shapes;
    bool takesOut(Id f) const { return std::find(gone.begin(), gone.end(), f) != gone.end(); }
    Span<Id> row(std::size_t i) const { return {rows[i].data(), rows[i].data() + rows[i].size()}; }
  };
  struct CellState : CellMeasures {
    double determinant = 1;
  };
  /// What one attempt touches and how it was before.
  struct Touched {
    std::vector<Id> shapes;  // faces of the points: their shape changes
    std::vector<Id> cells;   // cells of the points: volume and centre change
    std::vector<Id> faces;   // all faces of those cells: their angle changes
    // As they were; as many as have been touched so far.
    std::vector<Shape> oldShapes;
    std::vector<CellState> oldCells;
    std::vector<Relation> oldRelations;  // of the faces
    std::vector<Vec3> oldPoints;
  };
  class MoveOfAll;
  static constexpr double kAny = std::numeric_limits<double>::infinity();

  /// worst: kept only if better, from this badness on; kAny: if valid.
  NodeMover(PolyMesh& mesh, const QualityLimits& limits, MoverRegion region, const Monitor* monitor);
  void measureRim();

  Refusal attempt(const Id* points, const Vec3* targets, std::size_t count, double worst,
                  const std::function<bool()>& accept = {});
  void remeasure(Touched& t);
  void place(const Id* points, const Vec3* targets, Touched& t);
  void keep(const Id* points, const Touched& t);
  void noteChange(Id face, Id tick);
  void gather(const Id* points, std::size_t count, Touched& t) const;
  void gatherFaces(Touched& t) const;
  Refusal tryShapes(Touched& t, double worst);
  Refusal tryCells(Touched& t, double worst);
  Refusal tryAngles(Touched& t, double worst);
  void undo(const Id* points, const Touched& t);
  bool isBetter(const Touched& t) const;
  Refusal shapeRefuses(Id f, const Shape& now, const Shape& old) const;
  Refusal angleRefuses(Id f, const Relation& now, const Relation& old) const;
  Refusal cellRefuses(const CellState& now, const CellState& old) const;
  bool isInternal(Id f) const { return f < mesh_.internalFaces(); }
  double minEta(Id f) const { return isInternal(f) ? limits_.minEtaInternal : limits_.minEtaBoundary; }
  double minCos(Id f) const { return isInternal(f) ? cosInternal_ : cosBoundary_; }
  double maxSkew(Id f) const { return isInternal(f) ? limits_.maxSkewInternal : limits_.maxSkewBoundary; }
  double badnessOfShape(Id f, const Shape& shape) const;
  double badnessOfRelation(Id f, const Relation& s) const;
  double badnessOfCell(const CellMeasures& c) const;
  Shape shapeOf(Id f, Span<Id> row) const;
  Shape shapeNow(Id f) const { return shapeOf(f, mesh_.faces[f]); }
  /// other: null on the boundary.
  Relation relationOf(Id f, Span<Id> row, const Shape& s, const CellMeasures& own,
                      const CellMeasures* other) const;
  Relation relationNow(Id f) const {
    return relationOf(f, mesh_.faces[f], face(f), cell(mesh_.owner[f]),
                      isInternal(f) ? &cell(mesh_.neighbour[f]) : nullptr);
  }
  CellState cellNow(Id c) const;
  CellState cellWith(Id c, const Exchange& exchange) const;
  static CellState bestCell();
  static Shape bestShape();
  static Relation bestRelation();
  bool holdsWith(Exchange& exchange) const;

  Id slot(Id p) const { return region_.pointSlot[p]; }
  FaceState& face(Id f) { return faces_[region_.faceSlot[f]]; }
  const FaceState& face(Id f) const { return faces_[region_.faceSlot[f]]; }
  CellState& cell(Id c) { return cells_[region_.cellSlot[c]]; }
  const CellState& cell(Id c) const { return cells_[region_.cellSlot[c]]; }

  PolyMesh& mesh_;
  const Monitor* monitor_;
  QualityLimits limits_;
  double cosInternal_, cosBoundary_, cosWarpage_, minVolume_, minTet_;
  MoverRegion region_;
  std::vector<FaceState> faces_;
  std::vector<CellState> cells_;
  Id tick_ = 1;
  std::vector<std::atomic<Id>> changed_;  // tick of the last kept move in the cell or across a face of it
  inline static thread_local Trial* trial_ = nullptr;  // that this thread runs
  inline static thread_local Id now_ = 0;  // tick of the block's point that this thread moves; 0: none
};

struct NodeMover::Trial::Entry {
  std::vector<Id> points;
  Touched touched;
};

template <class Body>
void NodeMover::forEach(const std::vector<std::vector<Id>>& groups, const Body& body) {
  for (const auto& group : groups) {
    if (monitor_ && monitor_->aborted()) throw AbortError("Stopped on request.");
    ++tick_;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, group.size(), 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) body(group[i]);
    });
  }
}

template <class Body>
void NodeMover::forEach(const MoveBlocks& blocks, const Body& body) {
  struct Clock {
    ~Clock() { now_ = 0; }
  };
  for (const auto& group : blocks.groups) {
    if (monitor_ && monitor_->aborted()) throw AbortError("Stopped on request.");
    std::size_t longest = 0;
    for (Id block : group) longest = std::max(longest, blocks.points[block].size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, group.size()), [&](const auto& range) {
      const Clock clock;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        now_ = tick_;
        for (Id p : blocks.points[group[i]]) {
          ++now_;
          body(p);
        }
      }
    });
    tick_ += static_cast<Id>(longest);
  }
}

}  // namespace pm
