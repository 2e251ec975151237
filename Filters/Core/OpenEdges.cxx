// SPDX-License-Identifier: BSD-3-Clause
// Open edges as features: which ones count, and borders that belong together made one line; see
// FeatureNetwork.h.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "Bvh.h"
#include "ClosestPoint.h"
#include "FeatureNetwork.h"

namespace pm {

namespace {

// A triangle that shares a point with the edge is near it there in any case; beside the edge it counts only
// within this part of the distance to the shared point.
constexpr double kSharedPointSlope = 0.1;

/// What the triangles below a node of the model's tree have in common.
struct NodeFacing {
  Vec3 normal = Vec3::Zero();
  double spread = 0;  // degrees between the normal's line and that of any of them, at most
  Id patch = kNone;   // kNone = several
};

double anglesApart(const Vec3& u, const Vec3& v) {
  const double angle = angleBetween(u, v);
  return std::min(angle, 180 - angle);
}

/// Finds open edges beside which lies geometry that their triangle ought to be stitched to at an angle, or of
/// another patch. Parts of the model that face alike are passed over as a whole, and one find is enough: a
/// gap tolerance far above the size of the triangles costs no more than a small one.
class StitchSearch {
 public:
  StitchSearch(const SurfaceModel& model, const FeatureOptions& options)
      : model_(model), options_(options), bvh_(model.hierarchy()) {
    const auto ofSlot = [&](Id slot) {
      const Id t = bvh_.order()[slot];
      return NodeFacing{model.normal(t), 0, options.interfaces ? model.patchOf(t) : 0};
    };
    facing_ = bvh_.childValues<NodeFacing>(ofSlot, [](NodeFacing& into, const NodeFacing& other) {
      into.spread = std::max(into.spread, anglesApart(into.normal, other.normal) + other.spread);
      if (into.patch != other.patch) into.patch = kNone;
    });
  }

  bool isNearOther(const OpenEdge& edge) const {
    const Vec3& a = model_.points()[edge.a];
    const Vec3& b = model_.points()[edge.b];
    for (const double place : {1.0 / 6, 0.5, 5.0 / 6})
      if (isNearOther(edge, a + place * (b - a))) return true;
    return false;
  }

 private:
  bool isNearOther(const OpenEdge& edge, const Vec3& p) const {
    constexpr double kSlack = 1 - 1e-12;
    const double reach2 = options_.gapTolerance * options_.gapTolerance;
    const Id patch = options_.interfaces ? model_.patchOf(edge.triangle) : 0;
    const auto enter = [&](Id node, const Box& box) {
      return kSlack * box.distance2(p) <= reach2 && !facesLike(facing_[node], edge.triangle, patch);
    };
    return bvh_.any(enter, [&](Id slot) { return isOther(bvh_.order()[slot], edge, p); });
  }

  bool facesLike(const NodeFacing& all, Id triangle, Id patch) const {
    constexpr double kRounding = 1e-6;
    if (all.patch != patch || all.spread + kRounding > options_.sharpAngle) return false;
    return anglesApart(all.normal, model_.normal(triangle)) + all.spread + kRounding <= options_.sharpAngle;
  }

  bool isOther(Id t, const OpenEdge& edge, const Vec3& p) const {
    if (t == edge.triangle) return false;
    const bool otherPatch = options_.interfaces && model_.patchOf(t) != model_.patchOf(edge.triangle);
    if (!otherPatch && anglesApart(model_.normal(t), model_.normal(edge.triangle)) <= options_.sharpAngle)
      return false;
    double limit = options_.gapTolerance;
    for (Id corner : model_.triangles()[t])
      if (corner == edge.a || corner == edge.b)
        limit = std::min(limit, kSharedPointSlope * (model_.points()[corner] - p).norm());
    return model_.closestOnTriangle(p, t).distance2 <= limit * limit;
  }

  const SurfaceModel& model_;
  const FeatureOptions& options_;
  const Bvh& bvh_;
  std::vector<NodeFacing> facing_;
};

Box boxOf(const Vec3& p) {
  Box box;
  box.add(p);
  return box;
}

class Welder {
 public:
  Welder(FeatureNetwork& network, double tolerance)
      : network_(network), tolerance2_(tolerance * tolerance), firm_(network.points.size(), false) {
    for (const auto& link : network.links) firm_[link.a] = firm_[link.b] = true;
  }

  void run(const std::vector<OpenEdge>& open) {
    std::vector<FeatureNetwork::Link> loose;
    for (const OpenEdge& e : open) loose.push_back({e.a, e.b, kOpenEdge});
    if (tolerance2_ > 0) {
      joinPoints(loose);
      unifyLinks(loose);
      const LinkLookup firm(network_.points, network_.links);
      const std::vector<Id> points = pointsOf(loose);
      dropShort(loose);
      split(loose, points);
      unifyLinks(loose);
      dropCovered(loose, firm);
      splitFirm(loose, firm);
    }
    network_.links.insert(network_.links.end(), loose.begin(), loose.end());
    unifyLinks(network_.links);
  }

 private:
  using Links = FeatureNetwork::Links;

  static std::vector<Id> pointsOf(const Links& links) {
    std::vector<Id> ids;
    for (const auto& link : links) ids.insert(ids.end(), {link.a, link.b});
    sortUnique(ids);
    return ids;
  }

  Bvh bvhOver(const std::vector<Id>& points) const {
    std::vector<Box> boxes;
    for (Id p : points) boxes.push_back(boxOf(at(p)));
    return Bvh(boxes);
  }

  const Vec3& at(Id p) const { return network_.points[p]; }

  /// Loose points follow the nearest point of the links already there when it is within the tolerance, others
  /// the first loose point (by id) that stays.
  void joinPoints(Links& loose) {
    const std::vector<Id> points = pointsOf(loose), firmPoints = pointsOf(network_.links);
    const Bvh bvh = bvhOver(points), firmBvh = bvhOver(firmPoints);
    std::vector<Id> target(points.size(), kNone);
    tbb::parallel_for(std::size_t(0), points.size(),
                      [&](std::size_t i) { target[i] = nearestWithin(firmBvh, firmPoints, at(points[i])); });
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (target[i] != kNone) continue;
      const Vec3& p = at(points[i]);
      const auto gather = [&](Id slot) {
        const Id q = bvh.order()[slot];
        if (target[q] == kNone && (at(points[q]) - p).squaredNorm() <= tolerance2_) target[q] = points[i];
      };
      bvh.nearest(
          p, [&] { return tolerance2_; }, gather);
    }
    const auto resolve = [&](Id p) {
      return target[std::lower_bound(points.begin(), points.end(), p) - points.begin()];
    };
    for (auto& link : loose) {
      const auto [lo, hi] = std::minmax({resolve(link.a), resolve(link.b)});
      link.a = lo;
      link.b = hi;
    }
    loose.erase(std::remove_if(loose.begin(), loose.end(), [](const auto& l) { return l.a == l.b; }),
                loose.end());
  }

  Id nearestWithin(const Bvh& bvh, const std::vector<Id>& points, const Vec3& p) const {
    Id best = kNone;
    double best2 = tolerance2_;
    const auto offer = [&](Id slot) {
      const Id q = points[bvh.order()[slot]];
      const double distance2 = (at(q) - p).squaredNorm();
      if (distance2 < best2 || (distance2 == best2 && (best == kNone || q < best))) {
        best = q;
        best2 = distance2;
      }
    };
    bvh.nearest(
        p, [&] { return best2; }, offer);
    return best;
  }

  /// Splits every loose link at those of the points within the tolerance of it.
  void split(Links& loose, const std::vector<Id>& points) const {
    const Bvh bvh = bvhOver(points);
    std::vector<std::vector<Id>> on(loose.size());
    tbb::parallel_for(std::size_t(0), loose.size(), [&](std::size_t i) {
      const auto& link = loose[i];
      const auto offer = [&](Id slot) {
        const Id p = points[bvh.order()[slot]];
        LinkFoot foot;
        closestOnEdge(at(p), at(link.a), at(link.b), foot);
        if (p != link.a && p != link.b && foot.distance2 <= tolerance2_) on[i].push_back(p);
      };
      forBoxesAlong(link, [&](const Box& box) { bvh.overlapping(box, offer); });
    });
    std::vector<std::pair<Id, Id>> splits;
    for (std::size_t i = 0; i < loose.size(); ++i)
      for (Id p : on[i]) splits.push_back({static_cast<Id>(i), p});
    splitLinks(network_.points, loose, std::move(splits));
  }

  /// Short links between points of links already there run along those for certain. Where the tolerance is
  /// large there are very many, and their pieces would be far more.
  void dropShort(Links& loose) const {
    const auto isShort = [&](const FeatureNetwork::Link& l) {
      return firm_[l.a] && firm_[l.b] && (at(l.b) - at(l.a)).squaredNorm() <= 4 * tolerance2_;
    };
    loose.erase(std::remove_if(loose.begin(), loose.end(), isShort), loose.end());
  }

  /// Loose links that run along links already there say nothing new.
  void dropCovered(Links& loose, const LinkLookup& firm) const {
    std::vector<std::uint8_t> covered(loose.size(), 0);
    tbb::parallel_for(std::size_t(0), loose.size(), [&](std::size_t i) {
      const Vec3& a = at(loose[i].a);
      const Vec3& b = at(loose[i].b);
      covered[i] = 1;
      for (const double place : {0.0, 0.25, 0.5, 0.75, 1.0})
        if (covered[i] && !firm.reaches(a + place * (b - a), tolerance2_)) covered[i] = 0;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < loose.size(); ++i)
      if (!covered[i]) loose[kept++] = loose[i];
    loose.resize(kept);
  }

  /// Loose points beside a link already there move onto it and split it.
  void splitFirm(const Links& loose, const LinkLookup& firm) {
    std::vector<std::pair<Id, Id>> splits;  // (link, point)
    for (Id p : pointsOf(loose)) {
      if (firm_[p]) continue;
      const LinkFoot foot = firm.nearest(at(p), tolerance2_);
      if (foot.link == kNone) continue;
      network_.points[p] = foot.point;
      splits.push_back({foot.link, p});
    }
    splitLinks(network_.points, network_.links, std::move(splits));
  }

  /// Boxes that cover all points within the tolerance of a link; small ones, for a long slanting link's own
  /// box may hold the whole model.
  template <class Body>
  void forBoxesAlong(const FeatureNetwork::Link& link, const Body& body) const {
    const double tolerance = std::sqrt(tolerance2_);
    const Vec3 d = at(link.b) - at(link.a);
    const int pieces = static_cast<int>(std::clamp(d.norm() / (8 * tolerance), 1.0, 64.0));
    for (int k = 0; k < pieces; ++k) {
      Box box = boxOf(at(link.a) + d * (double(k) / pieces));
      box.add(at(link.a) + d * (double(k + 1) / pieces));
      box.lo.array() -= tolerance;
      box.hi.array() += tolerance;
      body(box);
    }
  }

  FeatureNetwork& network_;
  const double tolerance2_;
  std::vector<bool> firm_;  // points of links that were there before: they stay where they are
};

}  // namespace

std::vector<OpenEdge> chooseOpenEdges(const SurfaceModel& model, std::vector<OpenEdge> open,
                                      const FeatureOptions& options) {
  if (options.openEdges) return open;
  if (!(options.gapTolerance > 0)) return {};
  if (open.empty()) return open;
  const StitchSearch search(model, options);
  std::vector<std::uint8_t> keep(open.size(), 0);
  tbb::parallel_for(std::size_t(0), open.size(),
                    [&](std::size_t i) { keep[i] = search.isNearOther(open[i]); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (keep[i]) open[kept++] = open[i];
  open.resize(kept);
  return open;
}

void addOpenEdges(FeatureNetwork& network, const std::vector<OpenEdge>& open, double tolerance) {
  if (!open.empty()) Welder(network, tolerance).run(open);
}

}  // namespace pm
