// SPDX-License-Identifier: BSD-3-Clause
#include "Project.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ForcedMove.h"
#include "FreeFront.h"

namespace pm {
namespace {

// Steps below this part of the length scale are not worth their checks.
constexpr double kSmallStep = 0.02;
// Height of the wall prism the bases are led to, in units of the length scale: room for the layers, and near
// enough that the octree cells below take up most of the stretch.
constexpr double kPrismHeight = 0.4;
// The last rounds, in which the front has arrived and is smoothed along the geometry.
constexpr int kSettlingRounds = 4;
// Webs: how far off the geometry their middle is at least, how hard they pull their nodes and how far at
// most, in length scales.
constexpr double kOff = 0.1, kPull = 0.3, kMostPull = 0.3;
// A node farther than this from the geometry after projection, in length scales, is stuck. Rounds to free
// such nodes, and the part of them or of their way that may be left when another round is worth it; while
// they are few, of all wall nodes, it always is.
constexpr double kStuck = 0.02;
constexpr int kFreeingRounds = 12, kRingsAroundStuck = 2;
constexpr double kWorthFreeing = 0.8, kFew = 0.002;
// Only points whose worst measure is this near its limit can be what holds a node.
constexpr double kAtLimit = 0.8;
// A node farther than this from the geometry, in length scales, may lie behind another wall; a wall is
// between when it is met before this part of the way.
constexpr double kBeyond = 0.1, kThrough = 0.9;
// Octree nodes within so many edges of the bases may move; the core beyond keeps its perfect cells.
constexpr int kInnerRings = 2;

class Projector {
 public:
  Projector(PolyMesh& mesh, const DistanceField& field, const ProjectOptions& options, Monitor& monitor)
      : mesh_(mesh),
        field_(field),
        rounds_(options.rounds),
        monitor_(monitor),
        mover_(mesh, options.limits, pointsNearWall(mesh, kInnerRings), &monitor),
        wall_(wallSurface(mesh)),
        forced_(mover_, wall_) {
    wallBlocks_ = mover_.blocks(wall_.nodes);
    distance_.assign(wall_.size(), 0.0);
    web_.assign(mesh.boundaryFaces(), 0.0);
    tried_.assign(wall_.size(), 0);
    led_.assign(wall_.size(), 0);
    baseOffset_.assign(wall_.size(), Vec3::Zero());
    witness_ = baseOffset_;
    placeWitnesses();
    freeTried_.assign(mesh.points.size(), 0);
  }

  void run() {
    drift();
    settle();
    freeStuck();
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

 private:
  int driftingRounds() const { return std::max(1, rounds_ - kSettlingRounds); }

  // 4.6.2, gradual front drifting: to where the front would go if it were a surface by itself.
  void drift() {
    PartMonitor part(monitor_, 0, 0.1);
    const std::vector<Vec3> goal = freeFront(
        mesh_, wall_, [&](Id row, const Vec3& from) { return wayToGeometry(row, from); }, part);
    for (int left = driftingRounds(); left > 0; --left) {
      monitor_.check(0.1 + 0.3 * (1 - double(left) / driftingRounds()), "projection");
      const auto way = [&](Id row) -> Vec3 { return (goal[row] - mesh_.points[wall_.nodes[row]]) / left; };
      placeBases();
      leadAll([&](Id row) -> Vec3 { return mesh_.points[wall_.nodes[row]] + way(row); });
      mover_.forEach(wallBlocks_, [&](Id p) {
        const Id row = wall_.rowOf[p];
        if (led_[row] || moveWithBase(p, row, mesh_.points[p] + way(row))) return;
        if (!movePrismEdge(p, way(row))) movePrismEdge(p, 0.5 * way(row));
        if (left == 1) approachNode(p, row);
      });
    }
  }

  // 4.5.2, front smoothing: along the geometry, and webs into their gaps.
  void settle() {
    for (int round = driftingRounds(); round < rounds_; ++round) {
      monitor_.check(0.4 + 0.4 * (round - driftingRounds()) / kSettlingRounds, "front smoothing");
      findWebs();
      placeBases();
      leadAll([&](Id row) { return onGeometry(row, mesh_.points[wall_.nodes[row]] + stepAlong(row)); });
      mover_.forEach(wallBlocks_, [&](Id p) {
        const Id row = wall_.rowOf[p];
        if (led_[row])
          distance_[row] = 0;
        else if (mover_.worthTrying(p, tried_[row]))
          approachNode(p, row);
      });
    }
    std::fill(web_.begin(), web_.end(), 0.0);
  }

  void freeStuck() {
    std::size_t countBefore = wall_.nodes.size();
    double wayBefore = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kFreeingRounds; ++round) {
      monitor_.check(0.8 + 0.2 * round / kFreeingRounds, "freeing stuck nodes");
      const std::vector<Id> stuck = stuckNodes();
      double way = 0;
      for (Id row : stuck) way += distance_[row];
      const bool fewer = stuck.size() <= kWorthFreeing * countBefore,
                 nearer = way <= kWorthFreeing * wayBefore;
      if (stuck.empty() || !(fewer || nearer || stuck.size() <= kFew * wall_.size())) break;
      countBefore = stuck.size();
      wayBefore = way;
      forceNodes(stuck);
      freeNodes(stuck);
      approach(mover_.blocks(nodesAround(stuck)));
    }
    approach(wallBlocks_);
  }

  // 4.5.3: where the bases ought to be, below their wall nodes at one smooth height; ideal places are
  // averaged with the neighbours'.
  void placeBases() {
    std::vector<Vec3> smooth(wall_.size());
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      const Vec3 normal = mover_.areaVector(wall_.faces[row]).stableNormalized();
      baseOffset_[row] = -kPrismHeight * wall_.scale[row] * normal;
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

  /// Moves all wall nodes to their targets at once, with their bases; notes which got there. Most do, so that
  /// few are left to be moved one by one.
  template <class Target>
  void leadAll(const Target& target) {
    const std::size_t n = wall_.nodes.size();
    std::vector<Id> points(wall_.nodes);
    for (Id p : wall_.nodes) points.push_back(mesh_.base[p]);
    std::vector<Vec3> targets(2 * n);
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      const Vec3 to = target(row);
      targets[row] = to;
      targets[n + row] = 0.5 * (mesh_.points[points[n + row]] + to + baseOffset_[row]);
    });
    const std::vector<float> part = mover_.moveAll(points, std::move(targets));
    for (std::size_t row = 0; row < n; ++row) led_[row] = part[row] == 1;
  }

  bool movePrismEdge(Id p, const Vec3& way) {
    const Id b = mesh_.base[p];
    return mover_.moveTogether({p, b}, {mesh_.points[p] + way, mesh_.points[b] + way});
  }

  // A face over a gap has its nodes on the gap's lips, where closest points would keep them; what lies in the
  // gap behind would stay unmeshed. Such webs are the faces whose centre is off the geometry on the domain's
  // side.
  void findWebs() {
    tbb::parallel_for(Id(0), mesh_.boundaryFaces(), [&](Id b) {
      if (!mesh_.isWallPatch(mesh_.patch[b])) return;
      const Id f = mesh_.internalFaces() + b, row = wall_.rowOf[mesh_.faces[f][0]];
      const Vec3& centre = mover_.faceCentre(f);
      const double distance = std::sqrt(field_.closest(centre).distance2), scale = wall_.scale[row];
      const bool isWeb = distance >= kOff * scale && !field_.model().crosses(witness_[row], centre);
      web_[b] = isWeb ? std::min(distance, scale) : 0.0;
    });
  }

  /// The step by which webs pull a node along their normals; from there its way to the geometry leads down
  /// the lip.
  Vec3 pullOfWebs(Id row) const {
    Vec3 sum = Vec3::Zero();
    for (Id f : wall_.faces[row])
      if (const double off = web_[f - mesh_.internalFaces()]; off > 0)
        sum += kPull * off * mover_.faceNormal(f).stableNormalized();
    const double length = sum.norm(), most = kMostPull * wall_.scale[row];
    return length > most ? Vec3(most / length * sum) : sum;
  }

  // 4.6.2, front drifting, and 4.5.2, front smoothing, in one: a step in the tangent plane of the mesh
  // towards the middle of the faces around, and from there to the geometry.
  void approach(const MoveBlocks& blocks) {
    placeBases();
    mover_.forEach(blocks, [&](Id p) {
      const Id row = wall_.rowOf[p];
      if (mover_.worthTrying(p, tried_[row])) approachNode(p, row);
    });
  }

  /// A step towards the middle of the faces around, in their tangent plane, and as webs pull.
  Vec3 stepAlong(Id row) const {
    const FacesAround around = facesAround(
        wall_.faces[row], mesh_.points[wall_.nodes[row]], [&](Id f) { return mover_.faceCentre(f); },
        [&](Id f) { return mover_.faceNormal(f); });
    if (!around.haveArea || !(around.normal.norm() > 0)) return Vec3::Zero();
    const Vec3 mean = around.middle, n = around.normal.normalized();
    return 0.5 * (mean - mean.dot(n) * n) + pullOfWebs(row);
  }

  Vec3 onGeometry(Id row, const Vec3& from) const { return from + wayToGeometry(row, from); }

  void approachNode(Id p, Id row) {
    const Vec3 x = mesh_.points[p];
    distance_[row] = 0;
    const Vec3 step = stepAlong(row);
    if (step.norm() > kSmallStep * wall_.scale[row] && moveWithBase(p, row, onGeometry(row, x + step)))
      return;
    const Vec3 way = wayToGeometry(row, x);
    if (moveWithBase(p, row, x + way)) return;
    // The prism is in the way: take its foot along.
    const Id b = mesh_.base[p];
    if (mover_.moveTogether({p, b}, {x + way, mesh_.points[b] + 0.5 * way})) return;
    distance_[row] = (1 - 0.5 * mover_.drift(p, x + 0.5 * way, 2)) * way.norm();
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

  std::vector<Id> stuckNodes() const {
    std::vector<Id> rows;
    for (Id row = 0; row < wall_.size(); ++row)
      if (distance_[row] >= kStuck * wall_.scale[row]) rows.push_back(row);
    return rows;
  }

  /// The nodes of these rows and of some rings around them.
  std::vector<Id> nodesAround(std::vector<Id> rows) const {
    for (int ring = 0; ring < kRingsAroundStuck; ++ring) {
      const std::size_t inner = rows.size();
      for (std::size_t i = 0; i < inner; ++i) {
        const Span<Id> next = wall_.neighbours[rows[i]];
        rows.insert(rows.end(), next.begin(), next.end());
      }
      sortUnique(rows);
    }
    for (Id& row : rows) row = wall_.nodes[row];
    return rows;
  }

  // A node short of the geometry goes there by force, and its neighbours give way along the geometry.
  void forceNodes(const std::vector<Id>& stuck) {
    Csr<Id> points;
    for (Id row : stuck) points.push(forced_.points(row));
    mover_.forEach(mover_.colourRows(points), [&](Id i) {
      const Vec3& x = mesh_.points[wall_.nodes[stuck[i]]];
      const Vec3 to = x + wayToGeometry(stuck[i], x);
      if (forced_.force(stuck[i], points[i], to, [&](Id row) { giveWay(row); })) distance_[stuck[i]] = 0;
    });
  }

  void giveWay(Id row) {
    const bool arrived = distance_[row] < kStuck * wall_.scale[row];
    forced_.mendAlongWall(row, [&](const Vec3& to, double badness) {
      return mover_.improve(wall_.nodes[row], arrived ? field_.closest(to).point : to, badness);
    });
  }

  // It is held by a cell at a limit, often by a single sheared prism. The points of its cells search around
  // themselves for a place where the worst measure is better (4.5, second strategy).
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

  PolyMesh& mesh_;
  const DistanceField& field_;
  const int rounds_;
  Monitor& monitor_;
  NodeMover mover_;
  const WallSurface wall_;
  const ForcedMove forced_;
  MoveBlocks wallBlocks_;
  std::vector<double> distance_;  // #W to the geometry, as the node's last approach left it
  std::vector<double> web_;       // #boundary faces, of webs: how far their centre is off the geometry
  std::vector<Vec3> baseOffset_;  // #W ideal place of each base from its wall node
  std::vector<Vec3> witness_;     // #W a place in the domain behind each node
  std::vector<char> led_;         // #W got to its target with the others
  std::vector<Id> tried_;         // #W tick of the last attempt
  std::vector<Id> freeTried_;     // #P
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
  projector.run();
  const std::vector<StuckNode> told = projector.tellStuck();
  if (stuck != nullptr) *stuck = told;
  mesh.stage = Stage::Projected;
  canonicalise(mesh);
}

}  // namespace pm
