// SPDX-License-Identifier: BSD-3-Clause
#include "Membrane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "DisjointSets.h"
#include "RimFilms.h"

namespace pm {
namespace {

/// A face of the skin: a square of the smaller leaf on a plane of constant coordinate.
struct Face {
  Id inside, outside;
  Coord corner;  // lowest
  std::int32_t span;
  int axis;
  bool up;  // the outside lies on the upper side
};

std::vector<Face> skinFaces(const Octree& tree, const Csr<Id>& graph, const std::vector<Side>& sides) {
  std::vector<Face> faces;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (sides[leaf] != Side::Inside) continue;
    for (Id n : graph[leaf]) {
      if (sides[n] != Side::Outside) continue;
      const Id small = tree.levels[n] >= tree.levels[leaf] ? n : leaf;
      const Id large = small == n ? leaf : n;
      Face f{leaf, n, tree.corner(small), tree.brick.span(tree.levels[small]), 0, false};
      const Coord c = tree.corner(large);
      const std::int32_t span = tree.brick.span(tree.levels[large]);
      for (int a = 0; a < 3; ++a)
        if (f.corner[a] + f.span == c[a] || f.corner[a] == c[a] + span) f.axis = a;
      const bool largeAbove = f.corner[f.axis] + f.span == c[f.axis];
      if (largeAbove) f.corner[f.axis] += f.span;
      f.up = largeAbove == (large == n);
      faces.push_back(f);
    }
  }
  return faces;
}

Coord shifted(const Face& f, std::int32_t du, std::int32_t dv) {
  Coord c = f.corner;
  c[(f.axis + 1) % 3] += du;
  c[(f.axis + 2) % 3] += dv;
  return c;
}

/// Faces that share a corner, directly or through others: rows of faces.
std::vector<std::vector<Face>> connected(const std::vector<Face>& faces) {
  DisjointSets sets(faces.size());
  std::vector<std::pair<Key, Id>> corners;
  for (Id i = 0; i < static_cast<Id>(faces.size()); ++i)
    for (int k = 0; k < 4; ++k)
      corners.push_back({encode(shifted(faces[i], k & 1 ? faces[i].span : 0, k & 2 ? faces[i].span : 0)), i});
  std::sort(corners.begin(), corners.end());
  for (std::size_t k = 1; k < corners.size(); ++k)
    if (corners[k].first == corners[k - 1].first) sets.join(corners[k].second, corners[k - 1].second);
  std::vector<Id> row(faces.size(), kNone);
  std::vector<std::vector<Face>> groups;
  for (Id i = 0; i < static_cast<Id>(faces.size()); ++i) {
    const Id r = sets.root(i);
    if (row[r] == kNone) {
      row[r] = static_cast<Id>(groups.size());
      groups.emplace_back();
    }
    groups[row[r]].push_back(faces[i]);
  }
  return groups;
}

/// The faces as triangles of one size, so that no point hangs in an edge.
Membrane triangulated(const Octree& tree, const std::vector<Face>& faces) {
  std::int32_t unit = faces[0].span;
  for (const Face& f : faces) unit = std::min(unit, f.span);
  std::vector<std::array<Key, 4>> quads;
  std::vector<Id> faceOf;
  std::vector<Key> keys;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Face& f = faces[i];
    for (std::int32_t u = 0; u < f.span; u += unit)
      for (std::int32_t v = 0; v < f.span; v += unit) {
        std::array<Key, 4> quad{encode(shifted(f, u, v)), encode(shifted(f, u + unit, v)),
                                encode(shifted(f, u + unit, v + unit)), encode(shifted(f, u, v + unit))};
        if (!f.up) std::swap(quad[1], quad[3]);
        quads.push_back(quad);
        faceOf.push_back(static_cast<Id>(i));
        keys.insert(keys.end(), quad.begin(), quad.end());
      }
  }
  sortUnique(keys);
  Membrane m;
  for (Key key : keys) m.points.push_back(tree.brick.position(decode(key)));
  const auto id = [&](Key key) {
    return static_cast<Id>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  };
  for (std::size_t q = 0; q < quads.size(); ++q) {
    const auto& k = quads[q];
    const std::array<Id, 4> p{id(k[0]), id(k[1]), id(k[2]), id(k[3])};
    m.triangles.push_back({p[0], p[1], p[2]});
    m.triangles.push_back({p[0], p[2], p[3]});
    m.leafPairs.insert(m.leafPairs.end(), 2, {faces[faceOf[q]].inside, faces[faceOf[q]].outside});
  }
  return m;
}

// A hole of a few cells has a few squares only; smaller triangles let its rim follow the edge of the
// geometry.
void refineSmall(Membrane& m) {
  constexpr std::size_t enough = 256;
  while (m.triangles.size() < enough) {
    quarter(m.points, m.triangles);
    std::vector<std::array<Id, 2>> pairs;
    for (const auto& pair : m.leafPairs) pairs.insert(pairs.end(), 4, pair);
    m.leafPairs = std::move(pairs);
  }
}

/// Neighbours of each point along edges; points of edges with one triangle only are on the rim.
Csr<Id> neighbours(Membrane& m) {
  std::vector<std::array<Id, 2>> edges;
  for (const auto& t : m.triangles)
    for (int k = 0; k < 3; ++k)
      edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  m.onRim.assign(m.points.size(), 0);
  std::vector<std::array<Id, 2>> links;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end - i == 1) m.onRim[edges[i][0]] = m.onRim[edges[i][1]] = 1;
    links.push_back(edges[i]);
    links.push_back({edges[i][1], edges[i][0]});
    i = end;
  }
  std::sort(links.begin(), links.end());
  Csr<Id> graph;
  graph.offsets.assign(m.points.size() + 1, 0);
  for (const auto& link : links) {
    ++graph.offsets[link[0] + 1];
    graph.values.push_back(link[1]);
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  return graph;
}

/// Place of the largest clearance on a membrane, found by halving triangles: clearance changes no faster than
/// place.
struct Widest {
  Vec3 point = Vec3::Zero();
  double clearance = -1;
};

void searchTriangle(const SurfaceModel& model, const std::array<Vec3, 3>& t, double finest, Widest& best) {
  const Vec3 centre = (t[0] + t[1] + t[2]) / 3;
  const double here = std::sqrt(model.closest(centre).distance2);
  if (here > best.clearance) best = {centre, here};
  double reach = 0;
  for (const Vec3& p : t) reach = std::max(reach, (p - centre).norm());
  if (reach < finest || here + reach <= best.clearance) return;
  const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
  searchTriangle(model, {ab, bc, ca}, finest, best);
  searchTriangle(model, {t[0], ab, ca}, finest, best);
  searchTriangle(model, {ab, t[1], bc}, finest, best);
  searchTriangle(model, {ca, bc, t[2]}, finest, best);
}

void measure(Membrane& m, const Octree& tree, const SurfaceModel& model) {
  Widest best;
  for (const Vec3& p : m.points) {
    const double here = std::sqrt(model.closest(p).distance2);
    if (here > best.clearance) best = {p, here};
  }
  constexpr double accuracy = 0.02;  // of the smallest leaf
  const double finest = accuracy * tree.brick.edge(tree.brick.maxLevel);
  m.area = 0;
  for (const auto& ids : m.triangles) {
    const std::array<Vec3, 3> p{m.points[ids[0]], m.points[ids[1]], m.points[ids[2]]};
    m.area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    searchTriangle(model, p, finest, best);
  }
  m.bottleneck = best.point;
  m.width = 2 * best.clearance;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& pair : m.leafPairs) {
    const double d = (tree.box(pair[0]).centre() - m.bottleneck).norm() +
                     (tree.box(pair[1]).centre() - m.bottleneck).norm();
    if (d < nearest) nearest = d, m.crossing = pair;
  }
}

/// Twice the clearance that some crossing between leaves has for certain.
double leastWidth(const Membrane& m, const std::vector<double>& clearance) {
  double most = 0;
  for (const auto& [in, out] : m.leafPairs) most = std::max(most, std::min(clearance[in], clearance[out]));
  return 2 * most;
}

// On a surface in pieces a rim can slide off its end, and the membrane shrinks to nothing. It shows: the
// membrane is then narrower than the leaves that cross it. Such a membrane is made again with its rim held.
Membrane relaxed(const Membrane& start, const Octree& tree, const SurfaceModel& model,
                 const std::vector<double>& clearance, Monitor& monitor) {
  constexpr double credible = 0.8;  // floodSides takes a tenth for even width
  const double least = leastWidth(start, clearance);
  const double cell = tree.brick.edge(tree.brick.maxLevel);
  Membrane m;
  for (double slide : {std::numeric_limits<double>::infinity(), 2 * cell, 0.0}) {
    m = start;
    relax(m, model, slide, monitor);
    measure(m, tree, model);
    if (m.width >= credible * least) return m;
  }
  m.width = std::max(m.width, least);
  return m;
}

/// Row of the film that all of a skin follows within its own cells; kNone when there is none.
Id filmAlong(const Membrane& skin, const Octree& tree, const RimFilms* rims) {
  if (!rims || !rims->surface) return kNone;
  Id film = kNone;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const auto& ids = skin.triangles[t];
    const Vec3 centre = (skin.points[ids[0]] + skin.points[ids[1]] + skin.points[ids[2]]) / 3;
    double reach = 0;
    for (Id leaf : skin.leafPairs[t]) reach += tree.brick.edge(tree.levels[leaf]);
    const Closest c = rims->surface->closest(centre);
    const Id here = rims->surface->patchOf(c.triangle);
    if (c.distance2 > reach * reach || (film != kNone && here != film)) return kNone;
    film = here;
  }
  return film;
}

Vec3 areaVector(const Membrane& m) {
  Vec3 sum = Vec3::Zero();
  for (const auto& t : m.triangles)
    sum += 0.5 * (m.points[t[1]] - m.points[t[0]]).cross(m.points[t[2]] - m.points[t[0]]);
  return sum;
}

/// The film in place of a skin that follows it: its rim is the opening's own edge.
Membrane asFilm(const Membrane& skin, Membrane film, const Octree& tree, const SurfaceModel& model) {
  if (areaVector(skin).dot(areaVector(film)) < 0)
    for (auto& t : film.triangles) std::swap(t[1], t[2]);
  film.leafPairs = skin.leafPairs;
  measure(film, tree, model);
  return film;
}

}  // namespace

void quarter(std::vector<Vec3>& points, std::vector<std::array<Id, 3>>& triangles) {
  std::map<std::pair<Id, Id>, Id> middles;
  const auto middle = [&](Id a, Id b) {
    const auto [found, isNew] = middles.try_emplace({std::min(a, b), std::max(a, b)}, Id(points.size()));
    if (isNew) points.push_back(0.5 * (points[a] + points[b]));
    return found->second;
  };
  std::vector<std::array<Id, 3>> out;
  out.reserve(4 * triangles.size());
  for (const auto& t : triangles) {
    const Id ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    out.insert(out.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }
  triangles = std::move(out);
}

// Gauss-Seidel in the order of points: twice as fast as Jacobi, and the same for any number of threads.
void relax(Membrane& m, const SurfaceModel& model, double slide, Monitor& monitor,
           const std::vector<std::uint8_t>& held) {
  const Csr<Id> graph = neighbours(m);
  for (std::size_t p = 0; p < held.size(); ++p) m.onRim[p] |= held[p];
  for (std::size_t p = 0; p < m.points.size(); ++p)
    if (m.onRim[p]) m.points[p] = model.closest(m.points[p]).point;
  const std::vector<Vec3> start = m.points;
  constexpr int fewest = 20, most = 300;
  const int sweeps = std::clamp(static_cast<int>(2 * std::sqrt(double(m.points.size()))), fewest, most);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    monitor.check(double(sweep) / sweeps, "membranes");
    for (Id p = 0; p < static_cast<Id>(m.points.size()); ++p) {
      if (m.onRim[p] && slide <= 0) continue;
      Vec3 middle = Vec3::Zero();
      for (Id n : graph[p]) middle += m.points[n];
      middle /= double(graph[p].size());
      if (m.onRim[p]) {
        middle = model.closest(middle).point;
        if ((middle - start[p]).norm() > slide) continue;
      }
      m.points[p] = middle;
    }
  }
}

std::vector<Membrane> membranesBetween(const Octree& tree, const SurfaceModel& model,
                                       const std::vector<double>& clearance, const Csr<Id>& graph,
                                       const std::vector<Side>& sides, const RimFilms* rims,
                                       Monitor& monitor) {
  std::vector<Membrane> membranes;
  for (const std::vector<Face>& faces : connected(skinFaces(tree, graph, sides))) {
    Membrane start = triangulated(tree, faces);
    const Id film = filmAlong(start, tree, rims);
    if (film != kNone) {
      membranes.push_back(asFilm(start, rims->films[film], tree, model));
      continue;
    }
    refineSmall(start);
    membranes.push_back(relaxed(start, tree, model, clearance, monitor));
  }
  return membranes;
}

}  // namespace pm
