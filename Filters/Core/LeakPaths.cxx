// SPDX-License-Identifier: BSD-3-Clause
#include "LeakPaths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "Clearance.h"
#include "RimFilms.h"

namespace pm {
namespace {

/// Predecessor of each leaf on its way from the nearest source, over leaves of one side.
struct Ways {
  std::vector<Id> previous;  // kNone for sources and what is not reached
  std::vector<std::uint8_t> reached;
};

// Length counts more where it is narrow, so that ways keep to the middle of passages.
Ways waysFrom(const std::vector<Id>& sources, const Octree& tree, const std::vector<double>& clearance,
              const Csr<Id>& graph, const std::vector<Side>& sides, Side side) {
  using Entry = std::pair<double, Id>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> heap;
  std::vector<double> cost(tree.size(), std::numeric_limits<double>::infinity());
  Ways ways{std::vector<Id>(tree.size(), kNone), std::vector<std::uint8_t>(tree.size(), 0)};
  for (Id leaf : sources) {
    cost[leaf] = 0;
    heap.push({0, leaf});
  }
  while (!heap.empty()) {
    const auto [value, leaf] = heap.top();
    heap.pop();
    if (ways.reached[leaf]) continue;
    ways.reached[leaf] = 1;
    const Vec3 here = tree.box(leaf).centre();
    for (Id n : graph[leaf]) {
      if (sides[n] != side || ways.reached[n]) continue;
      const double step = (tree.box(n).centre() - here).norm() * (1 / clearance[leaf] + 1 / clearance[n]);
      if (value + step < cost[n]) {
        cost[n] = value + step;
        ways.previous[n] = leaf;
        heap.push({cost[n], n});
      }
    }
  }
  return ways;
}

double clearanceAt(const SurfaceModel& model, const Vec3& p) { return std::sqrt(model.closest(p).distance2); }

// Two points whose empty balls overlap see each other.
bool seeEachOther(const Vec3& a, double clearanceA, const Vec3& b, double clearanceB) {
  return (a - b).norm() < clearanceA + clearanceB;
}

/// Pulls the corners out of the path; a move stays in the point's own empty ball, keeps sight of both
/// neighbours, and does not make the passage look narrower.
void smooth(Leak& leak, const SurfaceModel& model) {
  constexpr int sweeps = 8;
  constexpr double keep = 0.9;  // of the clearance a point had
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (Id i = 1; i + 1 < static_cast<Id>(leak.path.size()); ++i) {
      if (i == leak.bottleneckRow) continue;
      const Vec3 wanted = 0.5 * leak.path[i] + 0.25 * (leak.path[i - 1] + leak.path[i + 1]);
      const double had = 0.5 * leak.widths[i];
      if ((wanted - leak.path[i]).norm() >= had) continue;
      const double has = clearanceAt(model, wanted);
      if (has < keep * had || !seeEachOther(wanted, has, leak.path[i - 1], 0.5 * leak.widths[i - 1]) ||
          !seeEachOther(wanted, has, leak.path[i + 1], 0.5 * leak.widths[i + 1]))
        continue;
      leak.path[i] = wanted;
      leak.widths[i] = 2 * has;
    }
}

std::vector<Id> traced(const Ways& ways, Id leaf) {
  std::vector<Id> way;
  for (; leaf != kNone; leaf = ways.previous[leaf]) way.push_back(leaf);
  return way;
}

Leak leakThrough(Membrane membrane, const Octree& tree, const SurfaceModel& model,
                 const std::vector<double>& clearance, const Ways& inner, const Ways& outer,
                 const LeakOptions& options) {
  Leak leak;
  leak.membrane = std::move(membrane);
  leak.bottleneck = leak.membrane.bottleneck;
  leak.width = leak.membrane.width;
  const auto add = [&](const Vec3& p, double c) {
    leak.path.push_back(p);
    leak.widths.push_back(2 * c);
  };
  const auto [in, out] = leak.membrane.crossing;
  std::vector<Id> way = traced(inner, in);
  std::reverse(way.begin(), way.end());
  // A given point sees the centre of its leaf, for nothing lies in the leaf.
  const auto addGiven = [&](const std::vector<Vec3>& points, Id end) {
    for (const Vec3& p : points)
      if (tree.locate(p) == end) return add(p, clearanceAt(model, p));
  };
  addGiven(options.insidePoints, way.front());
  for (Id leaf : way) add(tree.box(leaf).centre(), clearance[leaf]);
  const double half = 0.5 * leak.width;
  const bool onTheWay = seeEachOther(leak.bottleneck, half, tree.box(in).centre(), clearance[in]) &&
                        seeEachOther(leak.bottleneck, half, tree.box(out).centre(), clearance[out]);
  leak.bottleneckRow = static_cast<Id>(leak.path.size());
  if (onTheWay)
    add(leak.bottleneck, half);
  else if (clearance[in] < clearance[out])
    --leak.bottleneckRow;
  way = traced(outer, out);
  for (Id leaf : way) add(tree.box(leaf).centre(), clearance[leaf]);
  addGiven(options.outsidePoints, way.back());
  smooth(leak, model);
  return leak;
}

// Without a point, what lies behind a wide opening must fill this part of the geometry's box: a fillet that a
// film cuts off is no room.
constexpr double kWideRoom = 0.05;

/// Leaves to flood from, and the rooms they stand for.
struct Markers {
  std::vector<Marker> inside;
  std::vector<Id> outside, starts;  // starts: where paths begin
  std::vector<Pocket> pockets;
  std::vector<double> clearance;  // the order of flooding
  RimFilms rims;                  // what it is guided by, if anything
};

// Leaves in the empty ball around a given point are on its side too: nothing lies between.
void addBall(const Octree& tree, const std::vector<double>& clearance, const Csr<Id>& graph, Id leaf,
             std::vector<Marker>& into) {
  const Vec3 centre = tree.box(leaf).centre();
  std::vector<Id> stack{leaf};
  std::vector<std::uint8_t> seen(tree.size(), 0);
  seen[leaf] = 1;
  while (!stack.empty()) {
    const Id next = stack.back();
    stack.pop_back();
    into.push_back({next, clearance[leaf]});
    for (Id n : graph[next])
      if (!seen[n] && (tree.box(n).centre() - centre).norm() < clearance[leaf]) {
        seen[n] = 1;
        stack.push_back(n);
      }
  }
}

/// #L 1 = a way leads there from the given leaves.
std::vector<std::uint8_t> connectedWith(const std::vector<Id>& leaves, const Csr<Id>& graph) {
  std::vector<std::uint8_t> reached(graph.offsets.size() - 1, 0);
  std::vector<Id> stack = leaves;
  for (Id leaf : leaves) reached[leaf] = 1;
  while (!stack.empty()) {
    const Id leaf = stack.back();
    stack.pop_back();
    for (Id n : graph[leaf])
      if (!reached[n]) {
        reached[n] = 1;
        stack.push_back(n);
      }
  }
  return reached;
}

/// Leaves of the given points, which must not be outside already.
std::vector<Id> insideLeaves(const Octree& tree, const LeakOptions& options, const std::vector<Id>& outside) {
  std::vector<Id> leaves;
  for (const Vec3& p : options.insidePoints) {
    leaves.push_back(freeLeafAt(tree, p));
    if (std::find(outside.begin(), outside.end(), leaves.back()) != outside.end())
      throw InputError(
          fmt::format("The inside point ({:g}, {:g}, {:g}) is outside too; give another.", p[0], p[1], p[2]));
  }
  return leaves;
}

void addRooms(const Pockets& found, Markers& m) {
  for (const Pocket& p : found.pockets) {
    m.pockets.push_back(p);
    m.inside.push_back({p.peak, p.peakClearance});
    m.starts.push_back(p.peak);
  }
}

void addRoomOf(Id leaf, const Pockets& found, const Octree& tree, const Csr<Id>& graph, Markers& m) {
  m.starts.push_back(leaf);
  const Id room = found.pocketOfLeaf[leaf];
  if (room == kNone) {
    addBall(tree, m.clearance, graph, leaf, m.inside);
    m.pockets.push_back({leaf, m.clearance[leaf], m.clearance[leaf], 0});
  } else {
    const Pocket& pocket = found.pockets[room];
    m.inside.insert(m.inside.end(), {{leaf, m.clearance[leaf]}, {pocket.peak, pocket.peakClearance}});
    m.pockets.push_back(pocket);
  }
}

Markers chooseMarkers(const Octree& tree, const SurfaceModel& model, const std::vector<double>& clearance,
                      const Csr<Id>& graph, const LeakOptions& options, Monitor& monitor) {
  Markers m;
  m.clearance = clearance;
  m.outside =
      options.outsideLeaves.empty() ? outsideLeaves(tree, options.outsidePoints) : options.outsideLeaves;
  const std::vector<Id> given = insideLeaves(tree, options, m.outside);
  const double smallest = given.empty() ? options.smallestRoom * model.bounds().size().prod() : 0;
  Pockets found = findPockets(tree, clearance, graph, m.outside, options.roominess, smallest);
  bool noRoom = given.empty() && options.wideOpenings && found.pockets.empty();
  if (!given.empty()) {
    const std::vector<std::uint8_t> leaky = connectedWith(m.outside, graph);
    noRoom = std::any_of(given.begin(), given.end(),
                         [&](Id leaf) { return leaky[leaf] && found.pocketOfLeaf[leaf] == kNone; });
  }
  if (noRoom) {
    m.rims = spanRims(model, tree.brick.edge(tree.brick.maxLevel), monitor);
    m.clearance = guidedClearance(tree, clearance, m.rims);
    const double substantial = given.empty() ? kWideRoom * model.bounds().size().prod() : 0;
    found =
        findPockets(tree, m.clearance, graph, m.outside, options.roominess, std::max(smallest, substantial));
  }
  if (given.empty()) addRooms(found, m);
  for (Id leaf : given) addRoomOf(leaf, found, tree, graph, m);
  return m;
}

}  // namespace

double sealingSize(double width, const Brick& brick, RootCells roots) {
  constexpr double safely = 1.01;
  const double smallest = safely * width;
  if (roots == RootCells::FromFeature) return smallest;
  // The smallest leaf is between half the feature size and all of it; with the brick kept it is a power of
  // two below the root cell.
  if (brick.sidesArePatches) return 2 * smallest;
  double size = brick.edge(0);
  while (size < smallest) size *= 2;
  while (size / 2 > smallest) size /= 2;
  return size;
}

std::string describe(const std::vector<Leak>& leaks) {
  if (leaks.empty()) return {};
  const Leak& w = leaks.front();
  std::string more;
  if (leaks.size() > 1)
    more = fmt::format(" {} more leak{} narrower.", leaks.size() - 1, leaks.size() > 2 ? "s are" : " is");
  return fmt::format(
      "The widest leak is at ({:.4g}, {:.4g}, {:.4g}), {:.4g} wide; a feature size of {:.4g} seals it.{} "
      "Close "
      "Holes shows and closes leaks.",
      w.bottleneck[0], w.bottleneck[1], w.bottleneck[2], w.width, w.sealingSize, more);
}

LeakSearch findLeaks(const Octree& tree, const SurfaceModel& model, const LeakOptions& options,
                     Monitor& monitor) {
  LeakSearch search;
  const std::vector<double> clearance = leafClearance(tree, model, monitor, options.outsideLeaves);
  monitor.check(0.5, "flooding");
  const Csr<Id> graph = freeNeighbours(tree);
  Markers markers = chooseMarkers(tree, model, clearance, graph, options, monitor);
  search.pockets = std::move(markers.pockets);
  if (markers.inside.empty()) {
    search.sides.assign(tree.size(), Side::None);
    return search;
  }
  monitor.check(0.6, "flooding");
  search.sides = floodSides(tree, markers.clearance, graph, markers.inside, markers.outside);
  monitor.check(0.7, "membranes");
  std::vector<Membrane> membranes =
      membranesBetween(tree, model, clearance, graph, search.sides, &markers.rims, monitor);
  std::stable_sort(membranes.begin(), membranes.end(),
                   [](const Membrane& a, const Membrane& b) { return a.width > b.width; });
  if (options.maximumLeaks > 0 && static_cast<int>(membranes.size()) > options.maximumLeaks)
    membranes.resize(options.maximumLeaks);
  if (membranes.empty()) return search;
  monitor.check(0.9, "leak paths");
  const Ways inner = waysFrom(markers.starts, tree, clearance, graph, search.sides, Side::Inside);
  const Ways outer = waysFrom(markers.outside, tree, clearance, graph, search.sides, Side::Outside);
  for (Membrane& m : membranes) {
    search.leaks.push_back(leakThrough(std::move(m), tree, model, clearance, inner, outer, options));
    search.leaks.back().sealingSize = sealingSize(search.leaks.back().width, tree.brick, options.roots);
    search.leaks.back().wide = options.insidePoints.empty() && markers.rims.surface;
  }
  return search;
}

void throwLeak(const std::string& sentence, const Octree& tree, const SurfaceModel& model,
               const std::vector<Vec3>& insidePoints, const std::vector<Vec3>& outsidePoints,
               Monitor& monitor) {
  LeakOptions options;
  options.insidePoints = insidePoints;
  options.outsidePoints = outsidePoints;
  std::vector<Leak> leaks = findLeaks(tree, model, options, monitor).leaks;
  if (leaks.empty()) throw RegionError(sentence);
  const std::string more = describe(leaks);
  throw LeakError(sentence + " " + more, std::move(leaks));
}

void warnOfLargerRoom(double volume, const Octree& tree, const SurfaceModel& model, Monitor& monitor) {
  constexpr double little = 0.1, tiny = 1e-3, larger = 2;
  const double box = model.bounds().size().prod();
  if (volume > little * box) return;
  const LeakSearch search = findLeaks(tree, model, {}, monitor);
  if (search.leaks.empty() || search.pockets.front().volume <= larger * volume) {
    if (volume < tiny * box)
      monitor.warning(fmt::format(
          "The enclosed region is only {:.2g}% of the box around the geometry: all else is open, or "
          "too thin for cells of {:.4g} at the surface. Use a smaller feature size, close a wide "
          "opening (Close Holes, with a point inside), or mesh the outside.",
          100 * volume / box, tree.brick.edge(tree.brick.maxLevel)));
    return;
  }
  monitor.warning(fmt::format("The enclosed region has a volume of {:.4g}, but a room of {:.4g} leaks. {}",
                              volume, search.pockets.front().volume, describe(search.leaks)));
}

}  // namespace pm
