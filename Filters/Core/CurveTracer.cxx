// SPDX-License-Identifier: BSD-3-Clause
#include "CurveTracer.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "MeshQuality.h"

namespace pm {
namespace {

// Costs are lengths weighted by (kLength + squared distance over squared scale). A gap must lose against
// every path within reach (1.5 scales: 2.3), but win against a detour that leaves the curve.
constexpr double kLength = 0.05;
constexpr double kGap = 5.0;
constexpr double kEnterGap = 2.0;
constexpr double kAcross = 1.2;        // across a face: its cut makes two where one would do
constexpr double kMostDent = 0.1;      // scales that the ridge of a cut face may lie inside of it
constexpr double kBack = 2.0;          // for each length an edge runs against the curve
constexpr double kOnCurve = 2e-3;      // scales from the curve that count as on it
constexpr double kLargestBack = 0.35;  // scales an edge may run against the curve at most

}  // namespace

void CurveTracer::build(Task& task) {
  std::sort(task.nodes.begin(), task.nodes.end(), [](const NearNode& a, const NearNode& b) {
    return a.arc != b.arc ? a.arc < b.arc : a.row < b.row;
  });
  const double length = table_.length(task.curve);
  const double inf = std::numeric_limits<double>::infinity();
  vertices_.clear();
  const auto add = [&](double arc, double distance, Id row) {
    vertices_.push_back({arc, distance, inf, row, kNone, kNone, false});
  };
  start_ = end_ = kNone;
  if (task.startRow != kNone) {
    start_ = static_cast<Id>(vertices_.size());
    add(0, task.startDistance, task.startRow);
  }
  for (const NearNode& n : task.nodes) add(n.arc, n.distance, n.row);
  if (task.endRow != kNone) {
    end_ = static_cast<Id>(vertices_.size());
    add(length, task.endDistance, task.endRow);
  }
  nodeCount_ = static_cast<Id>(vertices_.size());
  for (Id v = 0; v < nodeCount_; ++v)
    localOf_[vertices_[v].row] = v;  // of a loop's two ends the second stays
  for (Id v = 0; v < nodeCount_; ++v) add(vertices_[v].arc, 0, kNone);
  add(length, 0, kNone);  // the goal
}

double CurveTracer::edgeCost(const Task& task, const Vertex& a, const Vertex& b) const {
  const Vec3 &p = mesh_.points[wall_.nodes[a.row]], &q = mesh_.points[wall_.nodes[b.row]];
  const double edge = (q - p).norm(), advance = b.arc - a.arc;
  const double length = table_.length(task.curve);
  if (advance < -kLargestBack * task.scale || advance > 3 * edge + task.scale) return -1;
  if (task.startRow != kNone && task.startRow == task.endRow && advance > 0.5 * length) return -1;
  const Vec3 middle = table_.at(task.curve, 0.5 * (a.arc + b.arc) + task.arcShift);
  const double scale = 0.5 * (wall_.scale[a.row] + wall_.scale[b.row]);
  const double m2 = (0.5 * (p + q) - middle).squaredNorm() / (scale * scale);
  const double d2 = (a.distance * a.distance + 4 * m2 + b.distance * b.distance) / 6;
  return edge * (kLength + d2) + kBack * std::max(0.0, -advance);
}

void CurveTracer::relax(Id from, Id to, double cost, Id cut) {
  Vertex& v = vertices_[to];
  if (v.done || !(cost < v.cost)) return;
  v.cost = cost;
  v.from = from;
  v.cut = cut;
  queue_.emplace_back(cost, to);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

/// Would all points of a face lie on the path if it went on from v to the point along an edge? The face would
/// end up on the curve as a whole.
bool CurveTracer::enclosesFace(Id v, Id point) const {
  const auto pointAt = [&](Id vertex) {
    return vertex == kNone || vertex >= nodeCount_ ? kNone : wall_.nodes[vertices_[vertex].row];
  };
  const Id from = vertices_[v].from, p = pointAt(v), q = pointAt(from);
  if (q == kNone) return false;
  const Id r = pointAt(vertices_[from].from);
  for (Id f : wall_.faces[vertices_[v].row]) {
    const Span<Id> row = mesh_.faces[f];
    const auto has = [&](Id x) { return x != kNone && std::find(row.begin(), row.end(), x) != row.end(); };
    if (!has(point) || !has(q)) continue;
    if (row.size() == 3 || vertices_[v].cut == f || (row.size() == 4 && has(r) && r != p)) return true;
  }
  return false;
}

void CurveTracer::relaxNode(const Task& task, Id v) {
  const Vertex a = vertices_[v];
  for (Id row : wall_.neighbours[a.row]) {
    const Id w = localOf_[row];
    if (w == kNone || w == v || vertices_[w].done) continue;
    const double cost = edgeCost(task, a, vertices_[w]);
    if (cost >= 0 && a.cost + cost < vertices_[w].cost && !enclosesFace(v, wall_.nodes[row]))
      relax(v, w, a.cost + cost);
  }
  if (canCut_) relaxAcross(task, v);
  relax(v, nodeCount_ + v, a.cost);
}

/// Would the face, cut from a to b and drawn to the curve, form a ridge into its cell? Such cells soon have
/// bad tetrahedra; a path along wall edges is better there.
bool CurveTracer::dents(Id face, const Vertex& a, const Vertex& b, const Task& task) const {
  const Id p = wall_.nodes[a.row], q = wall_.nodes[b.row];
  const Vec3 ridge = table_.at(task.curve, 0.5 * (a.arc + b.arc) + task.arcShift);
  Vec3 rest = Vec3::Zero();
  for (Id other : mesh_.faces[face])
    if (other != p && other != q) rest += mesh_.points[other];
  rest /= static_cast<double>(mesh_.faces[face].size() - 2);
  const Vec3 outward = measureFace(mesh_.points, mesh_.faces[face], true).normal.normalized();
  return (ridge - rest).dot(outward) < -kMostDent * task.scale;
}

/// Ways across the faces around a node; not where the path has come along the face already.
void CurveTracer::relaxAcross(const Task& task, Id v) {
  const Vertex a = vertices_[v];
  const Id p = wall_.nodes[a.row];
  for (Id f : wall_.faces[a.row]) {
    const Span<Id> row = mesh_.faces[f];
    const std::size_t n = row.size(), at = std::find(row.begin(), row.end(), p) - row.begin();
    if (n == 3) continue;
    if (a.from != kNone && a.from < nodeCount_ &&
        std::find(row.begin(), row.end(), wall_.nodes[vertices_[a.from].row]) != row.end())
      continue;
    for (std::size_t k = 2; k + 1 < n; ++k) {
      const Id q = row[(at + k) % n], w = localOf_[wall_.rowOf[q]];
      if (w == kNone || w == v || vertices_[w].done) continue;
      const double cost = kAcross * edgeCost(task, a, vertices_[w]);
      if (cost >= 0 && a.cost + cost < vertices_[w].cost && !dents(f, a, vertices_[w], task) &&
          canCut_({f, p, q}))
        relax(v, w, a.cost + cost, f);
    }
  }
}

void CurveTracer::relaxChain(const Task& task, Id v) {
  const Vertex a = vertices_[v];
  const Id node = v - nodeCount_, next = v + 1;
  if (node == nodeCount_) return;
  relax(v, next, a.cost + kGap * std::max(0.0, vertices_[next].arc - a.arc));
  if (node != start_) relax(v, node, a.cost + kEnterGap * task.scale);
}

void CurveTracer::search(const Task& task) {
  queue_.clear();
  const Id goal = 2 * nodeCount_;
  if (start_ != kNone)
    relax(kNone, start_, 0);
  else
    relax(kNone, nodeCount_, kGap * std::max(0.0, vertices_[nodeCount_].arc));
  while (!queue_.empty() && !vertices_[goal].done && (end_ == kNone || !vertices_[end_].done)) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [cost, v] = queue_.back();
    queue_.pop_back();
    if (vertices_[v].done) continue;
    vertices_[v].done = true;
    if (v < nodeCount_)
      relaxNode(task, v);
    else
      relaxChain(task, v);
  }
}

std::vector<std::vector<PathNode>> CurveTracer::unwind(const Task&) const {
  std::vector<std::vector<PathNode>> pieces;
  bool open = false;
  for (Id v = end_ != kNone ? end_ : 2 * nodeCount_; v != kNone; v = vertices_[v].from) {
    if (v >= nodeCount_) {
      open = false;
      continue;
    }
    if (!open) pieces.emplace_back();
    open = true;
    const Vertex& at = vertices_[v];
    pieces.back().push_back({at.row, at.arc, at.distance < kOnCurve, at.cut});
  }
  for (auto& piece : pieces) std::reverse(piece.begin(), piece.end());
  std::reverse(pieces.begin(), pieces.end());
  return pieces;
}

std::vector<std::vector<PathNode>> CurveTracer::trace(Task& task) {
  build(task);
  if (nodeCount_ == 0) return {};
  search(task);
  for (Id v = 0; v < nodeCount_; ++v) localOf_[vertices_[v].row] = kNone;
  return unwind(task);
}

}  // namespace pm
