// SPDX-License-Identifier: BSD-3-Clause
#include "WallFit.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace pm {
namespace {

// In units of the finest cell: how far a node may leave the geometry, what is not worth a move, and the
// distance beyond which a point's error is no chord's but a feature's that no shift of nodes would mend.
constexpr double kMostShift = 0.045, kLeastShift = 0.002, kMostChord = 0.12, kFar = 0.05;
constexpr int kSearchSweeps = 2;  // a third finds a better place for one node in two hundred
// Search along the surface: steps in length scales, and the gain that makes a new place worth it.
constexpr double kSteps[] = {0.5, 0.25, 0.1};
constexpr double kGain = 0.95;
constexpr std::size_t kMostPoints = 48;

/// The representative points around a node: itself, the middles of its edges on the wall, the centres of its
/// faces; and what of the geometry is closest to them.
struct Around {
  std::array<Vec3, kMostPoints> points;
  std::array<Closest, kMostPoints> found;
  std::size_t count = 0;
  void add(const Vec3& p) {
    if (count < kMostPoints) points[count++] = p;
  }
};

class WallFitter {
 public:
  WallFitter(NodeMover& mover, const WallSurface& wall, const DistanceField& field)
      : mover_(mover), wall_(wall), field_(field), unit_(mover.mesh().finestSize) {
    tried_.assign(wall.size(), 0);
    found_.assign(wall.size(), 0);
  }

  /// Moves nodes along their normals so that the points around each lie as far before the geometry as behind.
  void shift(const std::vector<Id>& nodes) {
    const Ways ways = waysToGeometry(nodes);
    std::vector<Vec3> targets(nodes.size());
    tbb::parallel_for(std::size_t(0), nodes.size(), [&](std::size_t i) {
      const Id row = wall_.rowOf[nodes[i]];
      const Vec3 n = mover_.areaVector(wall_.faces[row]).stableNormalized();
      const double way = shiftAt(row, n, ways);
      targets[i] = mover_.point(nodes[i]);
      if (std::abs(way) >= kLeastShift * unit_) targets[i] += way * n;
    });
    mover_.moveAll(nodes, std::move(targets));
  }

  // Maximum approximation (4.7.5): where a face stays off the geometry, often at an edge that found no path,
  // the node tries places around it on the surface.
  void search(Id p) {
    const Id row = wall_.rowOf[p];
    if (!mover_.worthTrying(p, tried_[row])) return;
    const Vec3 n = mover_.areaVector(wall_.faces[row]);
    Around at = around(p);
    double best = look(at);
    if (!(n.norm() > 0) || best < std::pow(kFar, 4)) return;
    const Vec3 u = n.unitOrthogonal(), v = n.normalized().cross(u);
    for (double step : kSteps)
      for (int k = 0; k < 8; ++k) {
        const double angle = k * 0.25 * 3.14159265358979323846;
        const Vec3 to =
            mover_.point(p) + step * wall_.scale[row] * (std::cos(angle) * u + std::sin(angle) * v);
        if (!mover_.moveIf(p, field_.closest(to).point, [&] { return isBelow(kGain * best, p, at); }))
          continue;
        found_[row] = 1;
        at = around(p);
        best = look(at);
      }
  }

  /// Of these nodes, those that have found a better place in the last sweep, and those beside one.
  std::vector<Id> unsettled(const std::vector<Id>& nodes) const {
    std::vector<Id> left;
    for (Id p : nodes) {
      const Id row = wall_.rowOf[p];
      const Span<Id> beside = wall_.neighbours[row];
      if (found_[row] || std::any_of(beside.begin(), beside.end(), [&](Id n) { return found_[n] != 0; }))
        left.push_back(p);
    }
    return left;
  }
  void startSweep() { std::fill(found_.begin(), found_.end(), 0); }

 private:
  /// From the representative points of the wall to the geometry; only of those around the nodes that shift.
  struct Ways {
    std::vector<Eigen::Vector3f> node, edge, face;  // #W, #neighbours.values, #boundary faces
  };

  Ways waysToGeometry(const std::vector<Id>& nodes) const {
    const PolyMesh& mesh = mover_.mesh();
    const Csr<Id>& beside = wall_.neighbours;
    std::vector<char> shifts(wall_.size(), 0), isAround(mesh.boundaryFaces(), 0);
    for (Id p : nodes) {
      shifts[wall_.rowOf[p]] = 1;
      for (Id f : wall_.faces[wall_.rowOf[p]]) isAround[f - mesh.internalFaces()] = 1;
    }
    Ways ways;
    ways.node.resize(wall_.size());
    ways.edge.resize(beside.values.size());
    ways.face.resize(mesh.boundaryFaces(), Eigen::Vector3f::Zero());
    const auto way = [&](const Vec3& from) -> Eigen::Vector3f {
      return (field_.closest(from).point - from).cast<float>();
    };
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      const Vec3& x = mover_.point(wall_.nodes[row]);
      if (shifts[row]) ways.node[row] = way(x);
      for (Id k = beside.offsets[row]; k < beside.offsets[row + 1]; ++k) {
        const Id other = beside.values[k];
        if (other < row || !(shifts[row] || shifts[other])) continue;
        const Span<Id> back = beside[other];
        const auto twin = std::lower_bound(back.begin(), back.end(), row) - back.begin();
        ways.edge[k] = way(0.5 * (x + mover_.point(wall_.nodes[other])));
        ways.edge[static_cast<std::size_t>(beside.offsets[other] + twin)] = ways.edge[k];
      }
    });
    tbb::parallel_for(Id(0), mesh.boundaryFaces(), [&](Id b) {
      if (isAround[b]) ways.face[b] = way(mover_.faceCentre(mesh.internalFaces() + b));
    });
    return ways;
  }

  double shiftAt(Id row, const Vec3& n, const Ways& ways) const {
    double lowest = 0, highest = 0;
    const auto add = [&](const Eigen::Vector3f& single) {
      const Vec3 way = single.cast<double>();
      if (way.norm() / unit_ >= kMostChord) return;
      lowest = std::min(lowest, way.dot(n));
      highest = std::max(highest, way.dot(n));
    };
    add(ways.node[row]);
    for (Id k = wall_.neighbours.offsets[row]; k < wall_.neighbours.offsets[row + 1]; ++k) add(ways.edge[k]);
    for (Id f : wall_.faces[row]) add(ways.face[f - mover_.mesh().internalFaces()]);
    const double own = ways.node[row].cast<double>().dot(n);
    return std::clamp(0.5 * (lowest + highest), own - kMostShift * unit_, own + kMostShift * unit_);
  }

  Around around(Id p) const {
    const Id row = wall_.rowOf[p];
    const Vec3& x = mover_.point(p);
    Around points;
    points.add(x);
    for (Id other : wall_.neighbours[row]) points.add(0.5 * (x + mover_.point(wall_.nodes[other])));
    for (Id f : wall_.faces[row]) points.add(mover_.faceCentre(f));
    return points;
  }

  // A point's capped distance to the fourth power; the sum over the points is close to the largest of them
  // but smooth.
  double weigh(const Closest& near) const {
    const double squared = std::min(near.distance2 / (unit_ * unit_), kMostChord * kMostChord);
    return squared * squared;
  }

  // The sum over the points; notes what is closest to each.
  double look(Around& at) const {
    double sum = 0;
    for (std::size_t i = 0; i < at.count; ++i) {
      at.found[i] = field_.closest(at.points[i]);
      sum += weigh(at.found[i]);
    }
    return sum;
  }

  // Is the sum below the limit with p where it is now? The triangles found before often prove that it is; and
  // often the points that were far away, which come first, that it is not.
  bool isBelow(double limit, Id p, const Around& before) const {
    const Around at = around(p);
    double most = 0;
    for (std::size_t i = 0; i < at.count && most < limit; ++i)
      most += weigh(field_.model().closestOnTriangle(at.points[i], before.found[i].triangle));
    if (most < limit) return true;
    std::array<std::size_t, kMostPoints> order;
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(at.count);
    std::iota(order.begin(), end, 0);
    std::sort(order.begin(), end, [&](std::size_t i, std::size_t j) {
      const double x = before.found[i].distance2, y = before.found[j].distance2;
      return x != y ? x > y : i < j;
    });
    double sum = 0;
    for (auto i = order.begin(); i != end && sum < limit; ++i)
      sum += weigh(field_.model().closest(at.points[*i], before.found[*i]));
    return sum < limit;
  }

  NodeMover& mover_;
  const WallSurface& wall_;
  const DistanceField& field_;
  const double unit_;
  std::vector<Id> tried_;    // #W tick of the last search
  std::vector<char> found_;  // #W better places; see unsettled()
};

}  // namespace

void fitWall(NodeMover& mover, const WallSurface& wall, const DistanceField& field,
             const std::vector<FitRole>& roles) {
  std::vector<Id> free, searching;
  for (Id row = 0; row < wall.size(); ++row) {
    if (roles[row] != FitRole::Keep) free.push_back(wall.nodes[row]);
    if (roles[row] == FitRole::Search) searching.push_back(wall.nodes[row]);
  }
  WallFitter fitter(mover, wall, field);
  fitter.shift(free);
  for (int sweep = 0; sweep < kSearchSweeps; ++sweep) {
    fitter.startSweep();
    mover.forEach(mover.blocks(searching), [&](Id p) { fitter.search(p); });
    fitter.shift(fitter.unsettled(free));
    searching = fitter.unsettled(searching);
  }
}

}  // namespace pm
