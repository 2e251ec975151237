// SPDX-License-Identifier: BSD-3-Clause
#include "CurveTracer.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace pm {
namespace {

// Costs are lengths weighted by (kLength + squared distance over squared scale). A gap must lose against
// every path within reach (1.5 scales: 2.3), but win against a detour that leaves the curve.
constexpr double kLength = 0.05;
constexpr double kGap = 5.0;
constexpr double kEnterGap = 2.0;
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
    vertices_.push_back({arc, distance, inf, row, kNone, false});
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

void CurveTracer::relax(Id from, Id to, double cost) {
  Vertex& v = vertices_[to];
  if (v.done || !(cost < v.cost)) return;
  v.cost = cost;
  v.from = from;
  queue_.emplace_back(cost, to);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

void CurveTracer::relaxNode(const Task& task, Id v) {
  const Vertex a = vertices_[v];
  for (Id row : wall_.neighbours[a.row]) {
    const Id w = localOf_[row];
    if (w == kNone || w == v || vertices_[w].done) continue;
    const double cost = edgeCost(task, a, vertices_[w]);
    if (cost >= 0) relax(v, w, a.cost + cost);
  }
  relax(v, nodeCount_ + v, a.cost);
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
    pieces.back().push_back({vertices_[v].row, vertices_[v].arc, vertices_[v].distance < kOnCurve});
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
