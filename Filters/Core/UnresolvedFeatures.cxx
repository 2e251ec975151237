// SPDX-License-Identifier: BSD-3-Clause
#include "UnresolvedFeatures.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "Bvh.h"
#include "ClosestPoint.h"

namespace pm {
namespace {

constexpr double kStep = 0.5;  // finest cells
constexpr double kFar = 12;    // the same; how far a wedge's tip may be from the cells that fit into it

// In length scales.
const double kReach = FeaturePathOptions().reach;  // wall nodes that might have taken the curve

constexpr double kLeast = 0.1;   // shorter parts are rounding at the ends of covered ones
constexpr double kClose = 0.7;   // another feature this near leaves no room for a row of faces between them
constexpr double kJoined = 1.5;  // but curves are near each other beside the corner they share

constexpr double kAcute = 55;  // degrees; whole cells do not fit into less
constexpr double kWedgeRadius = 0.25;
constexpr int kWedgeSteps = 72;

struct Answer {
  Unresolved why = Unresolved::NoPath;
  Refusal limit = Refusal::None;
  double size = 0;
  bool operator==(const Answer& b) const { return why == b.why && limit == b.limit; }
};

/// A wall node and its squared distance from a place.
struct NearNode {
  Id row = kNone;
  double distance2 = std::numeric_limits<double>::infinity();
};

class Explainer {
 public:
  Explainer(const WallView& view, const FeatureGraph& graph, const CurveTable& table,
            const std::vector<MissedTarget>& missed)
      : view_(view), graph_(graph), table_(table), missed_(missed), nodes_(nodeTree(view)) {}

  std::vector<UnresolvedFeature> run(const std::vector<CurveArc>& covered) const {
    const std::vector<CurveArc> open = openArcs(covered);
    std::vector<std::vector<UnresolvedFeature>> parts(open.size());
    tbb::parallel_for(std::size_t(0), open.size(), [&](std::size_t i) { explainArc(open[i], parts[i]); });
    std::vector<UnresolvedFeature> all;
    for (auto& p : parts) std::move(p.begin(), p.end(), std::back_inserter(all));
    return all;
  }

 private:
  static Bvh nodeTree(const WallView& view) {
    std::vector<Box> boxes(view.wall.nodes.size());
    for (std::size_t row = 0; row < boxes.size(); ++row)
      boxes[row].add(view.mesh.points[view.wall.nodes[row]]);
    return Bvh(boxes);
  }
  std::vector<CurveArc> openArcs(const std::vector<CurveArc>& covered) const;
  void explainArc(const CurveArc& arc, std::vector<UnresolvedFeature>& parts) const;
  Answer explain(Id curve, double arc) const;
  template <class Wanted>
  NearNode nearestNode(const Vec3& at, double reach, const Wanted& wanted) const;
  bool sees(Id row, const Vec3& at) const { return view_.sees(view_.wall.nodes[row], at); }
  const MissedTarget* missed(Id row) const;  ///< null for a node that reached its target or has none
  double closestOther(Id curve, const Vec3& at, double scale) const;
  bool meet(Id curve, Id other, const Vec3& at, double reach) const;
  double wedge(Id row, Id curve, double arc) const;

  const WallView& view_;
  const FeatureGraph& graph_;
  const CurveTable& table_;
  const std::vector<MissedTarget>& missed_;  // ascending by row
  const Bvh nodes_;                          // over wall rows
};

std::vector<CurveArc> Explainer::openArcs(const std::vector<CurveArc>& covered) const {
  const double least = kLeast * view_.mesh.finestSize;
  std::vector<CurveArc> open;
  auto next = covered.begin();
  for (Id c = 0; c < static_cast<Id>(graph_.curves().size()); ++c) {
    double end = 0;
    const auto add = [&](double to) {
      if (to - end > least) open.push_back({c, end, to});
    };
    for (; next != covered.end() && next->curve == c; ++next) {
      add(next->from);
      end = next->to;
    }
    add(table_.length(c));
  }
  return open;
}

template <class Wanted>
NearNode Explainer::nearestNode(const Vec3& at, double reach, const Wanted& wanted) const {
  NearNode best;
  nodes_.nearest(
      at, [&] { return std::min(best.distance2, reach * reach); },
      [&](Id slot) {
        const Id row = nodes_.order()[slot];
        const double d2 = (view_.mesh.points[view_.wall.nodes[row]] - at).squaredNorm();
        if (d2 > reach * reach || d2 > best.distance2 || (d2 == best.distance2 && row > best.row)) return;
        if (wanted(row)) best = {row, d2};
      });
  return best;
}

const MissedTarget* Explainer::missed(Id row) const {
  const auto it = std::lower_bound(missed_.begin(), missed_.end(), row,
                                   [](const MissedTarget& m, Id r) { return m.row < r; });
  return it != missed_.end() && it->row == row ? &*it : nullptr;
}

void Explainer::explainArc(const CurveArc& arc, std::vector<UnresolvedFeature>& parts) const {
  const double step = kStep * view_.mesh.finestSize, length = arc.to - arc.from;
  const int count = std::max(1, static_cast<int>(std::ceil(length / step)));
  Answer answer;
  double begin = arc.from;
  const auto close = [&](double end) {
    parts.push_back(
        {table_.part(arc.curve, begin, end), arc.curve, end - begin, answer.why, answer.limit, answer.size});
    begin = end;
  };
  for (int i = 0; i < count; ++i) {
    const Answer next = explain(arc.curve, arc.from + (i + 0.5) / count * length);
    if (i > 0 && next == answer) {
      answer.size = std::min(answer.size, next.size);
      continue;
    }
    if (i > 0) close(arc.from + i * length / count);
    answer = next;
  }
  close(arc.to);
}

Answer Explainer::explain(Id curve, double arc) const {
  const Vec3 at = table_.at(curve, arc);
  const double finest = view_.mesh.finestSize;
  NearNode node = nearestNode(at, kReach * finest, [&](Id row) { return sees(row, at); });
  if (node.row == kNone) {
    node = nearestNode(at, kFar * finest, [](Id) { return true; });
    const bool isWedge = node.row != kNone && sees(node.row, at) && wedge(node.row, curve, arc) < kAcute;
    return {isWedge ? Unresolved::Acute : Unresolved::NotOnWall, Refusal::None, 0};
  }
  const double scale = view_.wall.scale[node.row];
  const FeaturePathOptions paths;
  const double shortest = graph_.curves()[curve].closed ? paths.shortestLoop : paths.shortest;
  if (table_.length(curve) < shortest * scale)
    return {Unresolved::Short, Refusal::None, table_.length(curve) / shortest};
  const double other = closestOther(curve, at, scale);
  if (other < kClose * scale)
    return {Unresolved::TooClose, Refusal::None, other > 1e-3 * scale ? other : 0.0};
  if (wedge(node.row, curve, arc) < kAcute) return {Unresolved::Acute, Refusal::None, 0};
  const NearNode miss = nearestNode(at, scale, [&](Id row) { return missed(row) != nullptr; });
  if (miss.row != kNone) return {Unresolved::Limit, missed(miss.row)->limit, 0.5 * scale};
  return {Unresolved::NoPath, Refusal::None, 0.5 * scale};
}

/// Do two curves share a corner within the reach?
bool Explainer::meet(Id curve, Id other, const Vec3& at, double reach) const {
  const FeatureCurve &a = graph_.curves()[curve], &b = graph_.curves()[other];
  for (Id c : {a.startCorner, a.endCorner})
    if (c != kNone && (c == b.startCorner || c == b.endCorner) && (graph_.corners()[c] - at).norm() < reach)
      return true;
  return false;
}

double Explainer::closestOther(Id curve, const Vec3& at, double scale) const {
  const double reach = kClose * scale;
  Box box;
  box.add(at - Vec3::Constant(reach));
  box.add(at + Vec3::Constant(reach));
  double best2 = std::numeric_limits<double>::infinity();
  for (Id s : graph_.segmentsNear(box)) {
    const FeatureSegment& segment = graph_.segments()[s];
    if (segment.curve == curve || meet(curve, segment.curve, at, kJoined * scale)) continue;
    ClosestOnFeature found;
    closestOnEdge(at, segment.a, segment.b, found);
    best2 = std::min(best2, found.distance2);
  }
  return std::sqrt(best2);
}

/// Degrees around the curve that are free of geometry on the side of a wall node's prism edge.
double Explainer::wedge(Id row, Id curve, double arc) const {
  const Id p = view_.wall.nodes[row], base = view_.mesh.base[p];
  const double radius = kWedgeRadius * view_.wall.scale[row];
  const Vec3 at = table_.at(curve, arc);
  const Vec3 along =
      (table_.at(curve, arc + 0.1 * radius) - table_.at(curve, arc - 0.1 * radius)).normalized();
  if (base == kNone || !(along.norm() > 0.5)) return 360;
  Vec3 u = view_.mesh.points[base] - at;
  u -= along.dot(u) * along;
  if (!(u.norm() > 0)) return 360;
  u.normalize();
  const Vec3 v = along.cross(u);
  const auto place = [&](int k) {
    const double t = k * 2 * 3.14159265358979323846 / kWedgeSteps;
    return Vec3(at + radius * (std::cos(t) * u + std::sin(t) * v));
  };
  int free = 0;
  for (int side : {1, -1})
    for (int k = 0; k < kWedgeSteps / 2; ++k) {
      if (view_.model.crosses(place(side * k), place(side * (k + 1)))) break;
      ++free;
    }
  return free * 360.0 / kWedgeSteps;
}

}  // namespace

const char* describe(Unresolved why) {
  switch (why) {
    case Unresolved::NotOnWall:
      return "no wall of the mesh sees it";
    case Unresolved::Short:
      return "shorter than the mesh's edges";
    case Unresolved::TooClose:
      return "too close to another feature";
    case Unresolved::Acute:
      return "too acute";
    case Unresolved::Limit:
      return "a limit of the mesh";
    case Unresolved::NoPath:
      return "no free nodes along it";
  }
  return "";
}

std::vector<UnresolvedFeature> unresolvedFeatures(const WallView& view, const FeatureGraph& graph,
                                                  const CurveTable& table,
                                                  const std::vector<CurveArc>& covered,
                                                  const std::vector<MissedTarget>& missed) {
  return Explainer(view, graph, table, missed).run(covered);
}

}  // namespace pm
