// SPDX-License-Identifier: BSD-3-Clause
#include "PlanarMesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "MeshQuality.h"
#include "StarPolygons.h"

namespace pm {
namespace {

constexpr double kNear = 0.25;  // of an edge: a point nearer to the plane is moved onto it
constexpr double kLeast = 0.1;  // of an edge: so far from its ends is a node, when those are not on the plane
constexpr double kTiny = 1e-3;  // the same, of those that must be exact
constexpr int kMostRounds = 20;

/// A node of the section: on the edge from a point above the plane to one below it; or the point above
/// itself, twice, when it was moved onto the plane.
struct Node {
  Id above, below;
  bool operator<(const Node& n) const { return above != n.above ? above < n.above : below < n.below; }
  bool operator==(const Node& n) const { return above == n.above && below == n.below; }
};

/// A side of the section, as one of its cells has it: the cell on the left, seen from above.
struct Side {
  Id from, to, cell;
  Id patch;  // kNone inside the mesh
};

/// A directed edge of a polygon.
struct Edge {
  Id low, high, polygon;
  bool upward;
};

struct Section {
  std::vector<Node> nodes;
  std::vector<Side> sides;  // by cell
  Csr<Id> polygons;         // nodes, counter-clockwise from above
  std::vector<Id> cellOf;   // of each polygon
  std::vector<Edge> edges;  // of all polygons, by their nodes
};

class Cutter {
 public:
  Cutter(const PolyMesh& mesh, const PlanarMeshOptions& options)
      : mesh_(mesh), axis_(options.axis), position_(options.position) {}

  Section cut(Monitor& monitor) {
    monitor.check(0.1, "points at the plane");
    findCutFaces();
    findNearPoints();
    for (int round = 0;; ++round) {
      monitor.check(0.2 + 0.6 * round / kMostRounds, "section");
      Section section;
      findSides(section);
      std::set<Id> pinched, folded;
      tracePolygons(section, pinched);
      checkEdges(section, pinched);
      checkPolygons(section, folded);
      std::set<Id> faulty = pinched;
      faulty.insert(folded.begin(), folded.end());
      if (faulty.empty() && section.polygons.rows() == 0) refuseNoCut();
      if (faulty.empty()) return section;
      if (release(section, faulty) && round < kMostRounds) continue;
      if (!pinched.empty()) refuseSection();
      cutPolygons(section);
      return section;
    }
  }

  Vec3 place(const Node& node) const {
    const Vec3 &a = mesh_.points[node.above], &b = mesh_.points[node.below];
    Vec3 p = a;
    if (node.above != node.below) {
      const double part = height(node.above) / (height(node.above) - height(node.below));
      const double least = exact_.count(node) ? kTiny : kLeast;
      p += std::clamp(part, least, 1 - least) * (b - a);
    }
    p[axis_] = position_;
    return p;
  }
  std::uint8_t fixedAt(const Node& node) const { return mesh_.fixed[node.above] & mesh_.fixed[node.below]; }
  Id drawnTogether() const {
    return static_cast<Id>(
        std::count_if(cutFaces_.points.begin(), cutFaces_.points.end(), [&](Id p) { return near_[p] != 0; }));
  }

 private:
  [[noreturn]] void refuseNoCut() const {
    throw InputError(fmt::format(
        "The plane at {:g} does not cut the mesh; choose a position between its ends.", position_));
  }

  [[noreturn]] void refuseSection() const {
    throw InputError(fmt::format(
        "The section at {:g} has cells that are no simple polygons; choose another position.", position_));
  }

  double height(Id p) const { return mesh_.points[p][axis_] - position_; }
  bool isAbove(Id p) const { return near_[p] || height(p) >= 0; }

  template <class Body>
  static void forEachEdge(Span<Id> row, const Body& body) {
    Id p = row[row.size() - 1];
    for (Id q : row) {
      body(p, q);
      p = q;
    }
  }

  /// Faces with a point on either side, and the points of those.
  void findCutFaces() {
    near_.assign(mesh_.points.size(), 0);
    for (Id f = 0; f < mesh_.faceCount(); ++f) {
      const Span<Id> row = mesh_.faces[f];
      const auto up = [&](Id p) { return height(p) >= 0; };
      const auto above = std::count_if(row.begin(), row.end(), up);
      if (above == 0 || above == std::ptrdiff_t(row.size())) continue;
      cutFaces_.points.insert(cutFaces_.points.end(), row.begin(), row.end());
    }
    std::vector<Id>& points = cutFaces_.points;
    sortUnique(points);
    if (points.empty()) refuseNoCut();
    std::vector<char> at(mesh_.points.size(), 0);
    for (Id p : points) at[p] = 1;
    for (Id f = 0; f < mesh_.faceCount(); ++f) {
      const Span<Id> row = mesh_.faces[f];
      if (std::any_of(row.begin(), row.end(), [&](Id p) { return at[p] != 0; })) cutFaces_.faces.push_back(f);
    }
  }

  void findNearPoints() {
    std::vector<char> near(mesh_.points.size(), 0);
    for (Id f : cutFaces_.faces) {
      forEachEdge(mesh_.faces[f], [&](Id p, Id q) {
        const double a = std::abs(height(p)), b = std::abs(height(q));
        if ((height(p) >= 0) == (height(q) >= 0)) return;
        if (a < kNear * (a + b)) near[p] = 1;
        if (b < kNear * (a + b)) near[q] = 1;
      });
    }
    // A point from below must have something below it, or its cells would be gone.
    std::vector<char> based(mesh_.points.size(), 0);
    const auto isBase = [&](Id p) { return height(p) < 0 && !near[p]; };
    for (Id f : cutFaces_.faces)
      forEachEdge(mesh_.faces[f], [&](Id p, Id q) {
        if (isBase(q)) based[p] = 1;
        if (isBase(p)) based[q] = 1;
      });
    for (Id p : cutFaces_.points) near_[p] = near[p] && (height(p) >= 0 || based[p]);
  }

  Node nodeOn(Id above, Id below) const { return near_[above] ? Node{above, above} : Node{above, below}; }

  /// Each run of a face's points below the plane is a side between the edges at its ends.
  void findSides(Section& section) const {
    struct Found {
      Node from, to;
      Id face;
    };
    std::vector<Found> found;
    for (Id f : cutFaces_.faces) {
      const Span<Id> row = mesh_.faces[f];
      const std::size_t n = row.size();
      for (std::size_t i = 0; i < n; ++i) {
        if (!isAbove(row[i]) || isAbove(row[(i + 1) % n])) continue;
        std::size_t j = i + 1;
        while (!isAbove(row[(j + 1) % n])) ++j;
        const Found side{nodeOn(row[i], row[(i + 1) % n]), nodeOn(row[(j + 1) % n], row[j % n]), f};
        if (!(side.from == side.to)) found.push_back(side);
      }
    }
    std::vector<Node>& nodes = section.nodes;
    for (const Found& side : found) nodes.insert(nodes.end(), {side.from, side.to});
    sortUnique(nodes);
    const auto idOf = [&](const Node& n) {
      return static_cast<Id>(std::lower_bound(nodes.begin(), nodes.end(), n) - nodes.begin());
    };
    for (const Found& side : found) {
      const Id from = idOf(side.from), to = idOf(side.to), boundary = side.face - mesh_.internalFaces();
      section.sides.push_back(
          {from, to, mesh_.owner[side.face], boundary >= 0 ? mesh_.patch[boundary] : kNone});
      if (boundary < 0) section.sides.push_back({to, from, mesh_.neighbour[side.face], kNone});
    }
    std::stable_sort(section.sides.begin(), section.sides.end(),
                     [](const Side& a, const Side& b) { return a.cell < b.cell; });
  }

  /// The sides of each cell in loops; two sides are none. faulty: nodes at which a loop cannot go on.
  static void tracePolygons(Section& section, std::set<Id>& faulty) {
    std::vector<Side>& sides = section.sides;
    for (std::size_t first = 0, last; first < sides.size(); first = last) {
      for (last = first; last < sides.size() && sides[last].cell == sides[first].cell;) ++last;
      std::vector<char> used(last - first, 0);
      for (std::size_t start = first; start < last; ++start) {
        if (used[start - first]) continue;
        std::vector<Id> loop;
        for (std::size_t at = start; at != last && !used[at - first];) {
          used[at - first] = 1;
          loop.push_back(sides[at].from);
          const Id to = sides[at].to;
          at = first;
          while (at != last && (used[at - first] || sides[at].from != to)) ++at;
          if (at == last && to != loop.front()) faulty.insert({to, loop.front()});
        }
        std::vector<Id> different = loop;
        std::sort(different.begin(), different.end());
        const auto twice = std::adjacent_find(different.begin(), different.end());
        if (twice != different.end()) faulty.insert(*twice);
        if (loop.size() < 3) continue;
        section.polygons.push(loop);
        section.cellOf.push_back(sides[first].cell);
      }
    }
  }

  /// The nodes as seen from above.
  std::vector<Vec2> flatten(const Section& section) const {
    std::vector<Vec2> flat;
    for (const Node& node : section.nodes) {
      const Vec3 p = place(node);
      flat.emplace_back(p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]);
    }
    return flat;
  }

  void checkPolygons(const Section& section, std::set<Id>& folded) const {
    const std::vector<Vec2> flat = flatten(section);
    for (Id i = 0; i < section.polygons.rows(); ++i) {
      const Span<Id> row = section.polygons[i];
      if (!isStar(flat, row)) folded.insert(row.begin(), row.end());
    }
  }

  /// Sections of cells that are hollow on one side become several cells; one that is inside out is first
  /// joined with a neighbour.
  void cutPolygons(Section& section) const {
    const std::vector<Vec2> flat = flatten(section);
    std::vector<std::vector<Id>> loops;
    for (Id i = 0; i < section.polygons.rows(); ++i)
      loops.emplace_back(section.polygons[i].begin(), section.polygons[i].end());
    const auto partsOf = [&](const std::vector<Id>& loop) {
      return cutIntoStars(flat, {loop.data(), loop.data() + loop.size()});
    };
    for (std::size_t i = 0; i < loops.size(); ++i)
      if (!loops[i].empty() && partsOf(loops[i]).empty()) joinWithNeighbour(section, partsOf, Id(i), loops);
    Csr<Id> polygons;
    std::vector<Id> cellOf;
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (loops[i].empty()) continue;
      for (const std::vector<Id>& part : partsOf(loops[i])) {
        polygons.push(part);
        cellOf.push_back(section.cellOf[i]);
      }
    }
    section.polygons = std::move(polygons);
    section.cellOf = std::move(cellOf);
    std::set<Id> pinched;
    checkEdges(section, pinched);
    if (!pinched.empty()) refuseSection();
  }

  /// Adds a polygon to a neighbour in its zone with which it can be cut; its own loop is then empty.
  template <class PartsOf>
  void joinWithNeighbour(const Section& section, const PartsOf& partsOf, Id polygon,
                         std::vector<std::vector<Id>>& loops) const {
    const auto zoneOf = [&](Id i) { return mesh_.zone.empty() ? 0 : mesh_.zone[section.cellOf[i]]; };
    for (std::size_t e = 0; e + 1 < section.edges.size(); ++e) {
      const Edge &a = section.edges[e], &b = section.edges[e + 1];
      if (a.low != b.low || a.high != b.high || (a.polygon != polygon && b.polygon != polygon)) continue;
      const Id other = a.polygon == polygon ? b.polygon : a.polygon;
      if (zoneOf(other) != zoneOf(polygon) || loops[other].empty()) continue;
      const Edge& own = a.polygon == polygon ? a : b;
      const Id from = own.upward ? own.low : own.high, to = own.upward ? own.high : own.low;
      std::vector<Id> mine = loops[polygon], joined = loops[other];
      std::rotate(mine.begin(), std::find(mine.begin(), mine.end(), to), mine.end());            // to .. from
      std::rotate(joined.begin(), std::find(joined.begin(), joined.end(), from), joined.end());  // from .. to
      if (mine.back() != from || joined.back() != to) continue;  // it has been joined already
      joined.insert(joined.end(), mine.begin() + 1, mine.end() - 1);
      std::vector<Id> different = joined;
      std::sort(different.begin(), different.end());
      if (std::adjacent_find(different.begin(), different.end()) != different.end()) continue;
      if (partsOf(joined).empty()) continue;
      loops[other] = std::move(joined);
      loops[polygon].clear();
      return;
    }
    refuseSection();
  }

  /// Every edge must be in two polygons that run it both ways, or in one; every node in no boundary edge or
  /// in two.
  static void checkEdges(Section& section, std::set<Id>& faulty) {
    std::vector<Edge>& edges = section.edges;
    edges.clear();
    for (Id i = 0; i < section.polygons.rows(); ++i)
      forEachEdge(section.polygons[i], [&](Id p, Id q) {
        edges.push_back({std::min(p, q), std::max(p, q), i, p < q});
      });
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.polygon < b.polygon;
    });
    std::vector<int> rims(section.nodes.size(), 0);
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      for (last = first; last < edges.size() && edges[last].low == edges[first].low &&
                         edges[last].high == edges[first].high;)
        ++last;
      const bool pair = last - first == 2 && edges[first].upward != edges[first + 1].upward;
      if (last - first == 1) ++rims[edges[first].low], ++rims[edges[first].high];
      if (last - first != 1 && !pair) faulty.insert({edges[first].low, edges[first].high});
    }
    for (std::size_t n = 0; n < rims.size(); ++n)
      if (rims[n] != 0 && rims[n] != 2) faulty.insert(static_cast<Id>(n));
  }

  /// Points whose nodes are at fault are moved off the plane again, and nodes that still are go exactly where
  /// the plane cuts their edge; false when there is nothing left to do.
  bool release(const Section& section, const std::set<Id>& faulty) {
    bool any = false;
    for (Id n : faulty) {
      const Node& node = section.nodes[n];
      any |= near_[node.above] != 0 || exact_.insert(node).second;
      near_[node.above] = near_[node.below] = 0;
    }
    return any;
  }

  const PolyMesh& mesh_;
  const int axis_;
  const double position_;
  struct {
    std::vector<Id> points, faces;  // of the faces the plane cuts, and all faces at those points
  } cutFaces_;
  std::vector<char> near_;  // #P moved onto the plane
  std::set<Node> exact_;
};

/// Patch of each rim edge that is left: of any side between its nodes, the first boundary face's.
struct RimPatch {
  Id low, high, patch;
  bool operator<(const RimPatch& r) const { return low != r.low ? low < r.low : high < r.high; }
};

std::vector<RimPatch> rimPatches(const Section& section) {
  std::vector<RimPatch> rims;
  for (const Side& side : section.sides)
    if (side.patch != kNone)
      rims.push_back({std::min(side.from, side.to), std::max(side.from, side.to), side.patch});
  std::stable_sort(rims.begin(), rims.end());
  return rims;
}

std::string freeName(const std::vector<std::string>& names, std::string name) {
  while (std::find(names.begin(), names.end(), name) != names.end()) name += "_plane";
  return name;
}

/// The section moved to both sides: nodes below, then nodes above; quads between, then the two planes.
class Extruder {
 public:
  Extruder(const PolyMesh& mesh, const Section& section, const Cutter& cutter,
           const PlanarMeshOptions& options)
      : mesh_(mesh),
        section_(section),
        axis_(options.axis),
        half_(0.5 * (options.thickness > 0 ? options.thickness : mesh.finestSize)),
        count_(static_cast<Id>(section.nodes.size())) {
    for (double side : {-half_, half_}) {
      for (const Node& node : section.nodes) {
        out_.points.push_back(cutter.place(node));
        out_.points.back()[axis_] = options.position + side;
        out_.fixed.push_back(cutter.fixedAt(node) | std::uint8_t(1 << axis_));
      }
    }
    out_.base.assign(out_.points.size(), kNone);
  }

  PolyMesh build() {
    out_.patchNames = mesh_.patchNames;
    out_.patchTypes = mesh_.patchTypes;
    for (const char* name : {"back", "front"}) {
      out_.patchNames.push_back(freeName(mesh_.patchNames, name));
      out_.patchTypes.push_back("empty");
    }
    addQuads();
    addPlanes();
    addCells();
    canonicalise(out_);
    return std::move(out_);
  }

 private:
  void addQuads() {
    const std::vector<RimPatch> rims = rimPatches(section_);
    const std::vector<Edge>& edges = section_.edges;
    std::vector<std::size_t> rim;
    const auto push = [&](const Edge& edge) {
      const Id a = edge.upward ? edge.low : edge.high, b = edge.upward ? edge.high : edge.low;
      out_.faces.push(std::array<Id, 4>{a, b, b + count_, a + count_});
      out_.owner.push_back(edge.polygon);
    };
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const bool pair =
          i + 1 < edges.size() && edges[i + 1].low == edges[i].low && edges[i + 1].high == edges[i].high;
      if (!pair) {
        rim.push_back(i);
        continue;
      }
      push(edges[i]);
      out_.neighbour.push_back(edges[++i].polygon);
    }
    for (std::size_t i : rim) {
      push(edges[i]);
      const RimPatch wanted{edges[i].low, edges[i].high, kNone};
      const auto found = std::lower_bound(rims.begin(), rims.end(), wanted);
      if (found == rims.end() || wanted < *found)
        throw InternalError("A side of the section has cells on one side only, but no patch.");
      out_.patch.push_back(found->patch);
    }
  }

  void addPlanes() {
    const Id back = static_cast<Id>(out_.patchNames.size()) - 2;
    for (Id i = 0; i < section_.polygons.rows(); ++i) {
      const Span<Id> row = section_.polygons[i];
      std::vector<Id> below(std::make_reverse_iterator(row.end()), std::make_reverse_iterator(row.begin()));
      std::vector<Id> above(row.begin(), row.end());
      for (Id& n : above) n += count_;
      out_.faces.push(below);
      out_.faces.push(above);
      out_.owner.insert(out_.owner.end(), 2, i);
      out_.patch.insert(out_.patch.end(), {back, back + 1});
    }
  }

  void addCells() {
    out_.cellCount = section_.polygons.rows();
    for (Id c : section_.cellOf) {
      out_.level.push_back(mesh_.level[c]);
      out_.layer.push_back(mesh_.layer[c]);
      if (!mesh_.zone.empty()) out_.zone.push_back(mesh_.zone[c]);
    }
    out_.zoneNames = mesh_.zoneNames;
    out_.finestSize = mesh_.finestSize;
    out_.stage = Stage::Refined;
  }

  const PolyMesh& mesh_;
  const Section& section_;
  const int axis_;
  const double half_;
  const Id count_;
  PolyMesh out_;
};

}  // namespace

PolyMesh planarMesh(const PolyMesh& mesh, const PlanarMeshOptions& options, Monitor& monitor,
                    PlanarMeshReport* report) {
  if (options.axis < 0 || options.axis > 2)
    throw InputError(fmt::format("The axis must be x, y or z (0, 1, 2), not {}.", options.axis));
  if (!std::isfinite(options.position) || !std::isfinite(options.thickness) || options.thickness < 0)
    throw InputError("The position of the plane and the thickness must be lengths.");
  Cutter cutter(mesh, options);
  const Section section = cutter.cut(monitor);
  monitor.check(0.9, "one cell thick");
  PolyMesh out = Extruder(mesh, section, cutter, options).build();
  if (!report) return out;
  *report = PlanarMeshReport();
  report->cells = out.cellCount;
  report->drawnTogether = cutter.drawnTogether();
  const Id front = static_cast<Id>(out.patchNames.size()) - 1;
  for (Id b = 0; b < out.boundaryFaces(); ++b)
    if (out.patch[b] == front)
      report->area += measureFace(out.points, out.faces[out.internalFaces() + b], true).normal.norm();
  return out;
}

}  // namespace pm
