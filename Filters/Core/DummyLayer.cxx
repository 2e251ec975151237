// SPDX-License-Identifier: BSD-3-Clause
#include "DummyLayer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "NodeMover.h"

namespace pm {
namespace {

/// An edge of the front: its two points as the front face runs, and the boundary faces on either side.
struct FrontEdge {
  Id a, b;
  Id face;   // front face (index among boundary faces) that runs a -> b
  Id other;  // the boundary face across
};

class LayerBuilder {
 public:
  LayerBuilder(const PolyMesh& front, double thickness) : in_(front), thickness_(thickness) {}

  PolyMesh run() {
    out_ = in_;
    out_.faces = Csr<Id>();  // addCells makes them anew
    out_.stage = Stage::Layer;
    findDirections();
    addPoints();
    addCells();
    canonicalise(out_);
    return std::move(out_);
  }

 private:
  Id faceOf(Id boundaryFace) const { return in_.internalFaces() + boundaryFace; }
  Span<Id> row(Id boundaryFace) const { return in_.faces[faceOf(boundaryFace)]; }
  bool isFront(Id boundaryFace) const { return in_.isWallPatch(in_.patch[boundaryFace]); }

  // Eqs 4-1 (direction: face normals weighted with the angle at the node) and 4-2 (mean length of the front
  // edges).
  void findDirections() {
    direction_.assign(in_.points.size(), Vec3::Zero());
    length_.assign(in_.points.size(), 0.0);
    std::vector<Id> edges(in_.points.size(), 0);
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      if (!isFront(b)) continue;
      const Span<Id> r = row(b);
      const Vec3 normal = measureFace(in_.points, r, true).normal.normalized();
      for (std::size_t k = 0; k < r.size(); ++k) {
        const Vec3& p = in_.points[r[k]];
        const Vec3 next = in_.points[r[(k + 1) % r.size()]] - p,
                   last = in_.points[r[(k + r.size() - 1) % r.size()]] - p;
        direction_[r[k]] +=
            std::acos(std::clamp(next.dot(last) / (next.norm() * last.norm()), -1.0, 1.0)) * normal;
        for (const Vec3& e : {next, last}) length_[r[k]] += e.norm();
        edges[r[k]] += 2;
      }
    }
    for (std::size_t p = 0; p < in_.points.size(); ++p) {
      if (edges[p] == 0) continue;
      length_[p] /= edges[p];
      for (int a = 0; a < 3; ++a)
        if (in_.fixed[p] >> a & 1) direction_[p][a] = 0;  // stays on the domain side
      if (!(direction_[p].norm() > 0))
        throw InternalError(
            "A front node has no direction to grow a layer in; the front is not in permitted patterns.");
      direction_[p].normalize();
    }
  }

  void addPoints() {
    wallPoint_.assign(in_.points.size(), kNone);
    for (std::size_t p = 0; p < in_.points.size(); ++p) {
      if (!(length_[p] > 0)) continue;
      wallPoint_[p] = static_cast<Id>(out_.points.size());
      out_.points.push_back(in_.points[p] + thickness_ * length_[p] * direction_[p]);
      out_.fixed.push_back(in_.fixed[p]);
      out_.base.push_back(static_cast<Id>(p));
    }
  }

  std::vector<FrontEdge> frontEdges() const {
    struct Side {
      Id lo, hi, face;
      bool forward;
    };
    std::vector<Side> sides;
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      const Span<Id> r = row(b);
      for (std::size_t k = 0; k < r.size(); ++k) {
        const Id p = r[k], q = r[(k + 1) % r.size()];
        sides.push_back({std::min(p, q), std::max(p, q), b, p < q});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
      return std::tie(s.lo, s.hi, s.face) < std::tie(t.lo, t.hi, t.face);
    });
    std::vector<FrontEdge> edges;
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
      const Side &s = sides[i], &t = sides[i + 1];
      if (s.lo != t.lo || s.hi != t.hi)
        throw InternalError("The front is not manifold: an edge has not two faces.");
      if (!isFront(s.face) && !isFront(t.face)) continue;
      const Side &own = isFront(s.face) ? s : t, &across = isFront(s.face) ? t : s;
      edges.push_back({own.forward ? own.lo : own.hi, own.forward ? own.hi : own.lo, own.face, across.face});
    }
    return edges;
  }

  void addCells() {
    std::vector<Id> prism(in_.boundaryFaces(), kNone);
    Csr<Id> internal, boundary;
    std::vector<Id> owner, neighbour, boundaryOwner, patch;
    const std::vector<FrontEdge> edges = frontEdges();
    const std::size_t faces = in_.faceCount() + 2 * edges.size();  // a few too many: room, not a count
    internal.offsets.reserve(faces + 1);
    internal.values.reserve(in_.faces.values.size() + 6 * edges.size());
    owner.reserve(faces);
    neighbour.reserve(faces);
    for (Id f = 0; f < in_.internalFaces(); ++f) {
      internal.push(in_.faces[f]);
      owner.push_back(in_.owner[f]);
      neighbour.push_back(in_.neighbour[f]);
    }
    std::vector<Id> top;
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      const Id cell = in_.owner[faceOf(b)];
      if (!isFront(b)) {
        boundary.push(row(b));
        boundaryOwner.push_back(cell);
        patch.push_back(in_.patch[b]);
        continue;
      }
      prism[b] = out_.cellCount++;
      out_.level.push_back(in_.level[cell]);
      out_.layer.push_back(1);
      if (!in_.zone.empty()) out_.zone.push_back(in_.zone[cell]);
      internal.push(row(b));
      owner.push_back(cell);
      neighbour.push_back(prism[b]);
      top.clear();
      for (Id p : row(b)) top.push_back(wallPoint_[p]);
      boundary.push(top);
      boundaryOwner.push_back(prism[b]);
      patch.push_back(in_.patch[b]);
    }
    for (const FrontEdge& e : edges) {
      const std::array<Id, 4> quad{e.a, e.b, wallPoint_[e.b], wallPoint_[e.a]};
      if (isFront(e.other)) {
        internal.push(quad);
        owner.push_back(prism[e.face]);
        neighbour.push_back(prism[e.other]);
      } else {
        boundary.push(quad);
        boundaryOwner.push_back(prism[e.face]);
        patch.push_back(in_.patch[e.other]);
      }
    }
    for (Id b = 0; b < boundary.rows(); ++b) internal.push(boundary[b]);
    owner.insert(owner.end(), boundaryOwner.begin(), boundaryOwner.end());
    out_.faces = std::move(internal);
    out_.owner = std::move(owner);
    out_.neighbour = std::move(neighbour);
    out_.patch = std::move(patch);
  }

  const PolyMesh& in_;
  const double thickness_;
  std::vector<Vec3> direction_;
  std::vector<double> length_;
  std::vector<Id> wallPoint_;  // new point above each front node
  PolyMesh out_;
};

/// Points of cells outside a limit: wall points first, then their bases, then what else is there.
std::vector<Id> pointsInTrouble(const PolyMesh& mesh, const NodeMover& mover) {
  std::vector<Id> points;
  for (Id p = 0; p < static_cast<Id>(mesh.points.size()); ++p)
    if (mesh.base[p] != kNone && mover.badness(p) > 1) points.push_back(p);
  const std::size_t walls = points.size();
  for (std::size_t i = 0; i < walls; ++i) points.push_back(mesh.base[points[i]]);
  return points;
}

/// Limits tighter than a front of cubes can keep.
void warnOf(const std::vector<Id>& points, const PolyMesh& mesh, Monitor& monitor) {
  const Vec3& p = mesh.points[points.front()];
  monitor.warning(
      fmt::format("Prisms at {} points of the wall, the first at ({:g}, {:g}, {:g}), are outside the quality "
                  "limits and cannot be brought within; later stages make them no worse. Widen the limits.",
                  points.size() / 2, p[0], p[1], p[2]));
}

// Where the ideal directions give a prism outside the limits, points try small steps in all directions for a
// better one: the layer's step 2 (Fig. 4-7), by search instead of by rule.
void relax(PolyMesh& mesh, const QualityLimits& limits, Monitor& monitor) {
  NodeMover mover(mesh, limits, pointsNearWall(mesh, 0), &monitor);
  constexpr int kRounds = 12;
  for (int round = 0;; ++round) {
    monitor.check(0.3 + 0.6 * round / kRounds, "layer optimisation");
    const std::vector<Id> points = pointsInTrouble(mesh, mover);
    if (points.empty()) return;
    if (round == kRounds) return warnOf(points, mesh, monitor);
    const auto groups = mover.colour(points);
    mover.forEach(groups, [&](Id p) {
      const Id base = mesh.base[p];
      const double reach =
          base != kNone ? (mesh.points[p] - mesh.points[base]).norm() : 0.15 * mesh.finestSize;
      for (double step = 0.4 * reach; step > 0.04 * reach; step *= 0.5) {
        if (base != kNone)
          mover.improve(p, mesh.points[p] + step / reach * (mesh.points[base] - mesh.points[p]));
        for (int k = 0; k < 27; ++k) {
          if (k == 13) continue;
          const Vec3 d = Vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1).normalized();
          mover.improve(p, mesh.points[p] + step * d);
        }
      }
    });
  }
}

PolyMesh builtLayer(const PolyMesh& front, const DummyLayerOptions& options, Monitor& monitor) {
  if (!(options.thickness > 0) || options.thickness > 0.5)
    throw InputError(
        fmt::format("The layer's thickness must be above 0 and at most 0.5 of the edge length, not {:g}.",
                    options.thickness));
  monitor.check(0, "dummy layer");
  return LayerBuilder(front, options.thickness).run();
}

}  // namespace

PolyMesh dummyLayer(const PolyMesh& front, const DummyLayerOptions& options, Monitor& monitor) {
  PolyMesh mesh = builtLayer(front, options, monitor);
  relax(mesh, options.limits, monitor);
  return mesh;
}

PolyMesh dummyLayer(PolyMesh&& front, const DummyLayerOptions& options, Monitor& monitor) {
  PolyMesh mesh = builtLayer(front, options, monitor);
  front = PolyMesh();
  relax(mesh, options.limits, monitor);
  return mesh;
}

}  // namespace pm
