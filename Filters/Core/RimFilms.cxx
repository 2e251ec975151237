// SPDX-License-Identifier: BSD-3-Clause
#include "RimFilms.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pm {
namespace {

/// Edges of one triangle only, ascending; points are those of the model, which merges equal ones.
std::vector<std::array<Id, 2>> openEdges(const SurfaceModel& model) {
  std::vector<std::array<Id, 2>> edges, open;
  edges.reserve(3 * model.triangles().size());
  for (const auto& t : model.triangles())
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({a, b});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i == 1) open.push_back(edges[i]);
    i = end;
  }
  return open;
}

/// Walks along open edges, each of which is taken once.
class LoopFinder {
 public:
  LoopFinder(const std::vector<std::array<Id, 2>>& edges, std::size_t points)
      : edges_(edges), used_(edges.size(), 0), place_(points, kNone) {
    graph_.offsets.assign(points + 1, 0);
    for (const auto& e : edges) ++graph_.offsets[e[0] + 1], ++graph_.offsets[e[1] + 1];
    for (std::size_t p = 0; p < points; ++p) graph_.offsets[p + 1] += graph_.offsets[p];
    graph_.values.resize(2 * edges.size());
    std::vector<Id> next(graph_.offsets.begin(), graph_.offsets.end() - 1);
    for (std::size_t i = 0; i < edges.size(); ++i)
      for (Id p : edges[i]) graph_.values[next[p]++] = static_cast<Id>(i);
  }
  /// A walk that comes back to itself has closed a loop, which is cut off; dead ends are dropped.
  std::vector<std::vector<Id>> find() {
    std::vector<std::vector<Id>> loops;
    for (std::size_t first = 0; first < edges_.size(); ++first) {
      if (used_[first]) continue;
      walk_.clear();
      step(edges_[first][0]);
      while (!walk_.empty()) {
        const Id to = takeEdge(walk_.back());
        if (to == kNone) {
          place_[walk_.back()] = kNone;
          walk_.pop_back();
        } else if (place_[to] == kNone) {
          step(to);
        } else {
          loops.emplace_back(walk_.begin() + place_[to], walk_.end());
          while (walk_.back() != to) {
            place_[walk_.back()] = kNone;
            walk_.pop_back();
          }
        }
      }
    }
    return loops;
  }

 private:
  void step(Id point) {
    place_[point] = static_cast<Id>(walk_.size());
    walk_.push_back(point);
  }
  Id takeEdge(Id point) {
    for (Id e : graph_[point])
      if (!used_[e]) {
        used_[e] = 1;
        return edges_[e][0] == point ? edges_[e][1] : edges_[e][0];
      }
    return kNone;
  }
  const std::vector<std::array<Id, 2>>& edges_;
  Csr<Id> graph_;  // points to edges
  std::vector<std::uint8_t> used_;
  std::vector<Id> place_, walk_;  // place: row of each point in the walk
};

/// A fan about the middle of the loop, as fine as asked for, then relaxed with its rim held.
Membrane film(const std::vector<Vec3>& loop, const SurfaceModel& model, double cell, Monitor& monitor) {
  constexpr std::size_t most = 100000;  // triangles
  Membrane m;
  Vec3 middle = Vec3::Zero();
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& next = loop[(i + 1) % loop.size()];
    const double weight = (next - loop[i]).norm();
    middle += weight * 0.5 * (loop[i] + next);
    length += weight;
  }
  m.points = loop;
  m.points.push_back(middle / length);
  const Id n = static_cast<Id>(loop.size());
  for (Id i = 0; i < n; ++i) m.triangles.push_back({i, (i + 1) % n, n});
  double longest = 0;
  for (const Vec3& p : loop) longest = std::max(longest, (p - m.points[n]).norm());
  for (; longest > cell && 4 * m.triangles.size() <= most; longest /= 2) quarter(m.points, m.triangles);
  relax(m, model, 0, monitor);
  return m;
}

}  // namespace

RimFilms spanRims(const SurfaceModel& model, double cell, Monitor& monitor) {
  constexpr double shortest = 4;  // cells
  RimFilms rims;
  std::vector<Vec3> points;
  std::vector<SurfaceModel::Triangle> triangles;
  std::vector<Id> rows;
  for (const std::vector<Id>& ids : LoopFinder(openEdges(model), model.points().size()).find()) {
    std::vector<Vec3> loop;
    double length = 0;
    for (Id p : ids) {
      if (!loop.empty()) length += (model.points()[p] - loop.back()).norm();
      loop.push_back(model.points()[p]);
    }
    if (loop.size() < 3 || length + (loop.front() - loop.back()).norm() < shortest * cell) continue;
    rims.films.push_back(film(loop, model, cell, monitor));
    const Membrane& m = rims.films.back();
    const Id first = static_cast<Id>(points.size());
    points.insert(points.end(), m.points.begin(), m.points.end());
    for (const auto& t : m.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    rows.insert(rows.end(), m.triangles.size(), static_cast<Id>(rims.films.size()) - 1);
  }
  if (triangles.empty()) return {};
  const std::vector<std::string> names(rims.films.size());
  rims.surface = std::make_unique<SurfaceModel>(points, triangles, rows, names);
  return rims;
}

std::vector<double> guidedClearance(const Octree& tree, const std::vector<double>& clearance,
                                    const RimFilms& rims) {
  constexpr double last = 1e-3;
  std::vector<double> guided = clearance;
  if (!rims.surface) return guided;
  tbb::parallel_for(Id(0), tree.size(), [&](Id leaf) {
    if (tree.cut[leaf]) return;
    const double toFilm = std::sqrt(rims.surface->closest(tree.box(leaf).centre()).distance2);
    const double edge = tree.brick.edge(tree.levels[leaf]);
    guided[leaf] = std::min(clearance[leaf], toFilm);
    // The smallest width at last: a film in the plane between two leaves must not look like a passage.
    if (toFilm < edge) guided[leaf] = std::max(last * toFilm, std::numeric_limits<double>::min());
  });
  return guided;
}

}  // namespace pm
