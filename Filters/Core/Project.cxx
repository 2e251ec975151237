// SPDX-License-Identifier: BSD-3-Clause
#include "Project.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "NodeMover.h"
#include "WallSurface.h"

namespace pm {
namespace {

// A wall node this near, in units of its length scale, has arrived.
constexpr double kArrived = 1e-4;
// Smoothing steps below this part of the length scale are not worth their checks.
constexpr double kSmallStep = 0.02;
// Height of the wall prism the bases are led to, in units of the length scale: room for the layers, and near
// enough that the octree cells below take up most of the stretch.
constexpr double kPrismHeight = 0.4;
constexpr int kFlatteningSweeps = 3;
// Rounds after the front has arrived, in which it is only smoothed along the geometry.
constexpr int kSettlingRounds = 2;
// A node farther than this from the geometry after projection, in length scales, is stuck. Rounds to free
// such nodes, and the part of them or of their way that may be left when another round is worth it; while
// they are few, of all wall nodes, it always is.
constexpr double kStuck = 0.02;
constexpr int kFreeingRounds = 12;
constexpr double kWorthFreeing = 0.9, kFew = 0.002;
// Only points whose worst measure is this near its limit can be what holds a node.
constexpr double kAtLimit = 0.8;
// A node farther than this from the geometry, in length scales, may lie behind another wall; a wall is
// between when it is met before this part of the way.
constexpr double kBeyond = 0.1, kThrough = 0.9;
// Octree nodes within so many edges of the bases may move; the core beyond keeps its perfect cells.
constexpr int kInnerRings = 2;

class Projector {
 public:
  Projector(PolyMesh& mesh, const DistanceField& field, const ProjectOptions& options, const Monitor& monitor)
      : mesh_(mesh),
        field_(field),
        options_(options),
        mover_(mesh, options.limits, pointsNearWall(mesh, kInnerRings), &monitor),
        wall_(wallSurface(mesh)) {
    wallBlocks_ = mover_.blocks(wall_.nodes);
    distance_.assign(wall_.size(), 0.0);
    tried_.assign(wall_.size(), 0);
    baseOffset_.assign(wall_.size(), Vec3::Zero());
    witness_ = baseOffset_;
    placeWitnesses();
    innerTried_.assign(mesh.points.size(), 0);
    freeTried_ = innerTried_;
    collectInner();
  }

  /// Wall nodes still short of the geometry, each with what refuses its way there; one that may go, goes.
  std::vector<StuckNode> tellStuck() {
    std::vector<StuckNode> stuck;
    for (Id row : stuckNodes()) {
      const Id p = wall_.nodes[row];
      const Vec3 target = field_.closest(mesh_.points[p]).point;
      const Refusal refusal = mover_.tryMove(p, target);
      const double distance = (target - mesh_.points[p]).norm();
      if (distance >= kStuck * wall_.scale[row])
        stuck.push_back({mesh_.points[p], distance, describe(refusal)});
    }
    return stuck;
  }

  void run(Monitor& monitor) {
    const int rounds = std::max(options_.rounds, 1);
    for (int sweep = 0; sweep < kFlatteningSweeps; ++sweep) {
      monitor.check(0, "front flattening");
      flattenFront();
    }
    for (int round = 0; round < rounds; ++round) {
      monitor.check(0.9 * round / rounds, "projection");
      // The way is spread over the first rounds, so that all parts of the front arrive together: at a thin
      // edge, one side that comes first leaves the other no room.
      approach(1.0 / std::max(1, rounds - kSettlingRounds - round));
      if (round % 3 == 2) smoothInner();
    }
    std::size_t countBefore = wall_.nodes.size();
    double wayBefore = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kFreeingRounds; ++round) {
      monitor.check(0.9 + 0.1 * round / kFreeingRounds, "freeing stuck nodes");
      const std::vector<Id> stuck = stuckNodes();
      double way = 0;
      for (Id row : stuck) way += distance_[row];
      const bool fewer = stuck.size() <= kWorthFreeing * countBefore,
                 nearer = way <= kWorthFreeing * wayBefore;
      if (stuck.empty() || !(fewer || nearer || stuck.size() <= kFew * wall_.size())) break;
      countBefore = stuck.size();
      wayBefore = way;
      freeNodes(stuck);
      approach(1);
    }
    approach(1);
  }

 private:
  /// Outward unit normal of the wall at a node, from the faces around it.
  Vec3 normalAt(Id p) const {
    const Vec3 n = mover_.areaVector(wall_.faces[wall_.rowOf[p]]);
    const double length = n.norm();
    return length > 0 ? Vec3(n / length) : n;
  }

  /// Mean of the centres of the wall faces around a node, weighted by area (so that hanging nodes on the
  /// edges do not count), relative to the node; and the outward normal there. False where the faces have no
  /// area.
  bool meanAround(Id row, Vec3& mean, Vec3& normal) const {
    const Vec3& x = mesh_.points[wall_.nodes[row]];
    mean = normal = Vec3::Zero();
    double weight = 0;
    for (Id f : wall_.faces[row]) {
      const double area = mover_.faceNormal(f).norm();
      mean += area * (mover_.faceCentre(f) - x);
      weight += area;
      normal += mover_.faceNormal(f);
    }
    if (!(weight > 0) || !(normal.norm() > 0)) return false;
    mean /= weight;
    normal.normalize();
    return true;
  }

  // 4.5.1: smoothing flattens the front's stairs before it moves; a stair's riser has to lie down in the
  // surface, and folds if it is still upright when it gets there.
  void flattenFront() {
    placeBases();
    mover_.forEach(wallBlocks_, [&](Id p) {
      const Id row = wall_.rowOf[p];
      const Vec3 x = mesh_.points[p];
      Vec3 mean, normal;
      if (meanAround(row, mean, normal) && !moveWithBase(p, row, x + 0.5 * mean))
        mover_.move(p, x + 0.25 * mean);
    });
  }

  // 4.5.3: where the bases ought to be, below their wall nodes at one smooth height; ideal places are
  // averaged with the neighbours'.
  void placeBases() {
    std::vector<Vec3> smooth(wall_.size());
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      baseOffset_[row] = -kPrismHeight * wall_.scale[row] * normalAt(wall_.nodes[row]);
    });
    for (int sweep = 0; sweep < 2; ++sweep) {
      tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
        Vec3 sum = Vec3::Zero();
        for (Id other : wall_.neighbours[row]) sum += baseOffset_[other];
        smooth[row] = 0.5 * baseOffset_[row] + 0.5 * sum / std::max<double>(1, wall_.neighbours[row].size());
      });
      baseOffset_.swap(smooth);
    }
  }

  /// Moves a wall node and, half the way to its place, its base; the node alone where that is refused. Both
  /// at once cost no more than the base, as the node's cells are the base's too.
  bool moveWithBase(Id p, Id row, const Vec3& target) {
    const Id b = mesh_.base[p];
    const Vec3 step = 0.5 * (target + baseOffset_[row] - mesh_.points[b]);
    if (step.norm() > kSmallStep * wall_.scale[row] &&
        mover_.moveTogether({p, b}, {target, mesh_.points[b] + step}))
      return true;
    return mover_.move(p, target);
  }

  // 4.6.2, front drifting, and 4.5.2, front smoothing, in one: a step in the tangent plane of the mesh
  // towards the middle of the faces around, and from there part of the way to the closest point.
  void approach(double part) {
    if (part != lastPart_) std::fill(tried_.begin(), tried_.end(), 0);
    lastPart_ = part;
    placeBases();
    mover_.forEach(wallBlocks_, [&](Id p) {
      const Id row = wall_.rowOf[p];
      if (mover_.worthTrying(p, tried_[row])) approachNode(p, row, part);
    });
  }

  void approachNode(Id p, Id row, double part) {
    const Vec3 x = mesh_.points[p];
    Vec3 mean, n;
    if (meanAround(row, mean, n)) {
      const Vec3 step = 0.5 * (mean - mean.dot(n) * n);
      if (step.norm() > kSmallStep * wall_.scale[row] && driftPart(p, row, x + step, part)) return;
    }
    if (driftPart(p, row, x, part)) return;
    // The prism is in the way: take its foot along.
    const Vec3 way = wayToGeometry(row, x);
    const double distance = way.norm(), wanted = distance < kArrived * wall_.scale[row] ? 1 : part;
    const Id b = mesh_.base[p];
    if (mover_.moveTogether({p, b}, {x + wanted * way, mesh_.points[b] + 0.5 * wanted * way}))
      distance_[row] = (1 - wanted) * distance;
    else
      distance_[row] = (1 - 0.5 * wanted * mover_.drift(p, x + 0.5 * wanted * way, 2)) * distance;
  }

  // To the closest point, if the octree cell behind the wall sees it: its centre lies in the domain. A front
  // that reaches beyond the geometry may have the back of another wall closest; its way is to where the line
  // from that centre meets the geometry first.
  Vec3 wayToGeometry(Id row, const Vec3& from) const {
    const Vec3 closest = field_.closest(from).point, way = closest - from;
    if (way.norm() < kBeyond * wall_.scale[row]) return way;
    const Vec3& witness = witness_[row];
    const SurfaceModel& model = field_.model();
    const double met = model.firstCrossing(witness, from);
    if (met > 1 || !model.crosses(witness, witness + kThrough * (closest - witness))) return way;
    return witness + met * (from - witness) - from;
  }

  /// The centre of the nearest octree cell behind each wall node.
  void placeWitnesses() {
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      const Id b = mesh_.base[wall_.nodes[row]];
      double least = std::numeric_limits<double>::infinity();
      for (Id c : mover_.cellsOf(b)) {
        const double distance = (mover_.cellCentre(c) - mesh_.points[b]).squaredNorm();
        if (mesh_.layer[c] != 0 || distance >= least) continue;
        least = distance;
        witness_[row] = mover_.cellCentre(c);
      }
    });
  }

  /// Moves p to where part of the way from `from` to the geometry leads; false when it may not.
  bool driftPart(Id p, Id row, const Vec3& from, double part) {
    const Vec3 way = wayToGeometry(row, from);
    const double distance = way.norm();
    const double wanted = distance < kArrived * wall_.scale[row] ? 1 : part;
    if (!moveWithBase(p, row, from + wanted * way)) return false;
    distance_[row] = (1 - wanted) * distance;
    return true;
  }

  // 4.5.1: Laplacian, kept only where the worst local measure gets better.
  void smoothInner() {
    mover_.forEach(innerBlocks_, [&](Id p) {
      if (!mover_.worthTrying(p, innerTried_[p])) return;
      Vec3 mean = Vec3::Zero();
      for (Id c : mover_.cellsOf(p)) mean += mover_.cellCentre(c);
      const Vec3 step = 0.5 * (mean / double(mover_.cellsOf(p).size()) - mesh_.points[p]);
      if (step.norm() > kSmallStep * mesh_.finestSize) mover_.improve(p, mesh_.points[p] + step);
    });
  }

  std::vector<Id> stuckNodes() const {
    std::vector<Id> rows;
    for (Id row = 0; row < wall_.size(); ++row)
      if (distance_[row] >= kStuck * wall_.scale[row]) rows.push_back(row);
    return rows;
  }

  // A node short of the geometry is held by a cell at a limit, often by a single sheared prism. The points of
  // its cells search around themselves for a place where the worst measure is better (4.5, second strategy).
  void freeNodes(const std::vector<Id>& stuck) {
    std::vector<Id> around;
    for (Id row : stuck)
      for (Id c : mover_.cellsOf(wall_.nodes[row]))
        around.insert(around.end(), mover_.pointsOf(c).begin(), mover_.pointsOf(c).end());
    sortUnique(around);
    const auto atEase = [&](Id p) { return mover_.badness(p) < kAtLimit; };
    around.erase(std::remove_if(around.begin(), around.end(), atEase), around.end());
    mover_.forEach(mover_.blocks(around), [&](Id p) {
      if (!mover_.worthTrying(p, freeTried_[p])) return;
      double worst = mover_.badness(p);
      for (double step : {0.2, 0.07}) {
        for (int k = 0; k < 6; ++k) {
          Vec3 d = Vec3::Zero();
          d[k / 2] = k % 2 ? step : -step;
          if (mover_.improve(p, mesh_.points[p] + mesh_.finestSize * d, worst)) worst = mover_.badness(p);
        }
      }
    });
  }

  // Rings of nodes below the bases, by cells.
  void collectInner() {
    std::vector<std::uint8_t> marked(mesh_.points.size(), 0);
    for (Id p : wall_.nodes) marked[p] = marked[mesh_.base[p]] = 1;
    std::vector<Id> inner;
    for (int k = 0; k < kInnerRings; ++k) {
      const std::vector<Id> ring = nextRing(mesh_, marked);
      inner.insert(inner.end(), ring.begin(), ring.end());
    }
    innerBlocks_ = mover_.blocks(inner);
  }

  PolyMesh& mesh_;
  const DistanceField& field_;
  const ProjectOptions& options_;
  NodeMover mover_;
  WallSurface wall_;
  MoveBlocks wallBlocks_, innerBlocks_;
  std::vector<double> distance_;            // of each wall node to the geometry, as its last drift left it
  double lastPart_ = 0;                     // of the way, in the last drift
  std::vector<Vec3> baseOffset_;            // #W ideal place of each base from its wall node
  std::vector<Vec3> witness_;               // #W a place in the domain behind each node
  std::vector<Id> tried_;                   // #W tick of the last attempt
  std::vector<Id> innerTried_, freeTried_;  // #P
};

}  // namespace

void project(PolyMesh& mesh, DistanceField& field, const ProjectOptions& options, Monitor& monitor,
             std::vector<StuckNode>* stuck) {
  monitor.check(0, "distance field");
  std::vector<Vec3> walls;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.base[p] != kNone) walls.push_back(mesh.points[p]);
  field.fill(walls);
  Projector projector(mesh, field, options, monitor);
  projector.run(monitor);
  const std::vector<StuckNode> told = projector.tellStuck();
  if (stuck != nullptr) *stuck = told;
  mesh.stage = Stage::Projected;
  canonicalise(mesh);
}

}  // namespace pm
