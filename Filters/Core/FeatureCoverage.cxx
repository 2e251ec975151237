// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureCoverage.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

namespace pm {
namespace {

constexpr double kOn = 0.1;  // length scales from a feature that count as on it

/// Parts of curves that the wall edges from one node to later ones cover.
void coverFrom(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
               const CurveTable& table, Id row, std::vector<CurveArc>& arcs) {
  const Vec3& p = mesh.points[wall.nodes[row]];
  const double reach = kOn * wall.scale[row];
  Box box;
  box.add(p - Vec3::Constant(reach));
  box.add(p + Vec3::Constant(reach));
  Id done = kNone;
  for (Id segment : graph.segmentsNear(box)) {
    const Id curve = graph.segments()[segment].curve;
    if (curve == done) continue;
    done = curve;
    const auto arcAt = [&](const Vec3& at, double& arc) {
      const ClosestOnFeature on = graph.closestOnCurve(at, curve);
      Vec3 unused;
      arc = table.project(at, on.segment, unused);
      return on.distance2 <= reach * reach;
    };
    double s, t, m;
    if (!arcAt(p, s)) continue;
    for (Id n : wall.neighbours[row]) {
      const Vec3& q = mesh.points[wall.nodes[n]];
      if (n < row || !arcAt(q, t) || !arcAt(0.5 * (p + q), m)) continue;
      const double lo = std::min(s, t), hi = std::max(s, t), length = table.length(curve);
      if (hi - lo <= 3 * (q - p).norm()) {
        arcs.push_back({curve, lo, hi});
      } else if (graph.curves()[curve].closed) {
        arcs.push_back({curve, hi, length});
        arcs.push_back({curve, 0, lo});
      }
    }
  }
}

/// Makes overlapping arcs one.
std::vector<CurveArc> united(std::vector<CurveArc> arcs) {
  std::sort(arcs.begin(), arcs.end(), [](const CurveArc& a, const CurveArc& b) {
    return std::tie(a.curve, a.from, a.to) < std::tie(b.curve, b.from, b.to);
  });
  std::size_t kept = 0;
  for (const CurveArc& a : arcs) {
    if (kept > 0 && arcs[kept - 1].curve == a.curve && a.from <= arcs[kept - 1].to)
      arcs[kept - 1].to = std::max(arcs[kept - 1].to, a.to);
    else
      arcs[kept++] = a;
  }
  arcs.resize(kept);
  return arcs;
}

Id coveredCorners(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph) {
  std::vector<char> hit(graph.corners().size(), 0);
  for (Id row = 0; row < wall.size(); ++row) {
    const Vec3& p = mesh.points[wall.nodes[row]];
    const double reach = kOn * wall.scale[row];
    Box box;
    box.add(p - Vec3::Constant(reach));
    box.add(p + Vec3::Constant(reach));
    for (Id segment : graph.segmentsNear(box)) {
      const FeatureCurve& curve = graph.curves()[graph.segments()[segment].curve];
      for (Id c : {curve.startCorner, curve.endCorner})
        if (c != kNone && (graph.corners()[c] - p).norm() <= reach) hit[c] = 1;
    }
  }
  return static_cast<Id>(std::count(hit.begin(), hit.end(), 1));
}

}  // namespace

std::vector<CurveArc> coveredArcs(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
                                  const CurveTable& table) {
  constexpr Id kBlock = 512;
  std::vector<std::vector<CurveArc>> blocks((wall.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t b) {
    const Id first = static_cast<Id>(b) * kBlock, last = std::min(wall.size(), first + kBlock);
    for (Id row = first; row < last; ++row) coverFrom(mesh, wall, graph, table, row, blocks[b]);
  });
  std::vector<CurveArc> arcs;
  for (const auto& block : blocks) arcs.insert(arcs.end(), block.begin(), block.end());
  return united(std::move(arcs));
}

ResolveFeaturesReport featureCoverage(const PolyMesh& mesh, const WallSurface& wall,
                                      const FeatureGraph& graph, const CurveTable& table,
                                      const std::vector<CurveArc>& covered) {
  ResolveFeaturesReport report;
  for (std::size_t c = 0; c < graph.curves().size(); ++c)
    report.featureLength += table.length(static_cast<Id>(c));
  for (const CurveArc& arc : covered) report.resolvedLength += arc.to - arc.from;
  report.corners = static_cast<Id>(graph.corners().size());
  report.resolvedCorners = coveredCorners(mesh, wall, graph);
  return report;
}

}  // namespace pm
