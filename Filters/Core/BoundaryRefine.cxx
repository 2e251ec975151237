// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryRefine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "CutColumns.h"
#include "LayerCheck.h"
#include "LayerRoom.h"
#include "LayerSearch.h"
#include "LayerSplit.h"

namespace pm {
namespace {

const char* const kChoosing = "choosing layers";
constexpr int kRounds = 2;  // of search before layers are taken away

void checkMesh(const PolyMesh& mesh) {
  if (mesh.stage < Stage::Layer || mesh.base.size() != mesh.points.size()) {
    throw InputError("The mesh has no prismatic layer to refine; apply DummyLayer and Project first.");
  }
  if (mesh.stage == Stage::Refined) {
    throw InputError("The mesh has its boundary layers already; refine the mesh of the stage before.");
  }
}

/// Area vector of a column's wall, out of the mesh.
Vec3 roofArea(const PolyMesh& mesh, const LayerColumns& columns, Id column) {
  Vec3 sum = Vec3::Zero();
  for (Id f : columns.roof(column)) sum += measureFace(mesh.points, mesh.faces[f], true).normal;
  return sum;
}

/// Most layers that fit on an edge with the last at least as high as the one before it. Layers that share the
/// prism's height always do.
Id fittingLayers(double length, const EdgeHeights& heights, Id wanted) {
  Id layers = 1;
  const auto needed = [&](Id n) { return 2 * heights.sum(n) - heights.sum(n - 1); };
  while (layers < wanted && length >= needed(layers)) ++layers;
  return layers;
}

/// Lowers columns until those side by side differ by one layer at most; returns all that changed, ascending.
std::vector<Id> grade(LayerColumns& columns, std::vector<Id> changed) {
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const Id most = columns.layers(changed[i]) + 1;
    columns.forEachBeside(changed[i], [&](Id other) {
      if (columns.layers(other) <= most) return;
      columns.setLayers(other, most, LayerReason::NeighbourLayers);
      changed.push_back(other);
    });
  }
  sortUnique(changed);
  return changed;
}

/// checkMesh fails cells of an aspect ratio above 1000, which thin layers on large faces may reach.
void warnOfAspect(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<EdgeHeights>& heights,
                  Monitor& monitor) {
  constexpr double kMostAspect = 1000;
  double widest = 0;
  for (Id c = 0; c < columns.count(); ++c) {
    if (columns.layers(c) == 1) continue;
    const double area = roofArea(mesh, columns, c).norm();
    for (Id b : columns.ring(c)) widest = std::max(widest, std::sqrt(area) / heights[b].first);
  }
  if (widest <= kMostAspect) return;
  monitor.warning(
      fmt::format("Cells at the wall are up to {:.0f} times as wide as high; OpenFOAM's checkMesh "
                  "complains above {:.0f}. Use smaller cells at the wall or a larger first height.",
                  widest, kMostAspect));
}

std::vector<Id> allColumns(const LayerColumns& columns) {
  std::vector<Id> all(columns.count());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// The layers wished for, as far as they fit, graded.
void planLayers(const PolyMesh& mesh, LayerColumns& columns, const LayerDemands& demands,
                const std::vector<EdgeHeights>& heights) {
  for (Id c = 0; c < columns.count(); ++c) {
    if (!columns.canSplit(c)) continue;
    const LayerDemand& demand = demands.ofColumn(mesh, columns, c);
    columns.want(c, demand.layers);
    Id layers = demand.layers;
    for (Id b : columns.ring(c)) {
      const double length = (mesh.points[b] - mesh.points[columns.wallPoint(b)]).norm();
      if (demand.first > 0 || !(length > 0))
        layers = std::min(layers, fittingLayers(length, heights[b], layers));
    }
    if (layers < demand.layers) columns.setLayers(c, layers, LayerReason::NoRoom);
    if (demand.layers == 1 && demands.mostLayers() > 1) columns.setLayers(c, 1, LayerReason::NotWanted);
  }
  const std::vector<Id> all = allColumns(columns);
  grade(columns, all);
  columns.updateEdges(all);
}

/// Columns that share an edge with one of the changed.
std::vector<Id> touched(const LayerColumns& columns, const std::vector<Id>& changed) {
  std::vector<Id> all, near;
  std::vector<std::uint8_t> seen(columns.count(), 0);
  for (Id c : changed) {
    columns.around(c, near);
    for (Id other : near) {
      if (!seen[other]) all.push_back(other);
      seen[other] = 1;
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Id> columnsOf(const std::vector<LayerCheck::Fault>& faults) {
  std::vector<Id> columns;
  for (const LayerCheck::Fault& fault : faults) columns.push_back(fault.column);
  return columns;
}

/// What a column was to have before any limit was looked at.
struct PlannedLayers {
  Id layers;
  LayerReason reason;
};

/// Gives columns layers back that they lost for a neighbour that has lost some since, one by one, as long as
/// nothing breaks a limit (the iterative splitting of thesis 4.8).
void raiseAgain(LayerColumns& columns, LayerPoints& points, LayerCheck& check,
                const std::vector<PlannedLayers>& planned, Monitor& monitor) {
  std::vector<Id> around;
  LayerTrial trial = check.trial();
  const auto measureWith = [&](Id c, Id layers) {
    columns.setLayers(c, layers, columns.reason(c));
    columns.updateEdges({c});
    for (Id b : columns.ring(c)) points.follow(b);
    trial.gather(around);
    return trial.cost();
  };
  std::vector<Id> todo = allColumns(columns);  // later those around which something has changed
  while (!todo.empty()) {
    monitor.check(0.7, kChoosing);
    std::vector<Id> raised;
    for (Id c : todo) {
      const Id layers = columns.layers(c);
      bool graded = layers < planned[c].layers;
      columns.forEachBeside(c, [&](Id other) { graded = graded && columns.layers(other) >= layers; });
      if (!graded) continue;
      columns.around(c, around);
      if (measureWith(c, layers + 1) > 0) {
        measureWith(c, layers);
        continue;
      }
      raised.push_back(c);
      if (layers + 1 == planned[c].layers) columns.setLayers(c, layers + 1, planned[c].reason);
    }
    todo = touched(columns, touched(columns, raised));
  }
}

/// Takes a layer from each of these columns; returns all whose layers or edges have changed.
std::vector<Id> lower(LayerColumns& columns, const std::vector<LayerCheck::Fault>& faults) {
  for (const LayerCheck::Fault& fault : faults)
    columns.setLayers(fault.column, columns.layers(fault.column) - 1, fault.reason);
  std::vector<Id> graded = grade(columns, columnsOf(faults));
  columns.updateEdges(graded);
  return graded;
}

/// Layers divide faces of the cells beside columns, too, and ends of edges that have moved change their
/// shape; such a cell may reach columns far from any that was looked at. What that breaks shows when all is
/// done.
void lowerBesideCells(LayerColumns& columns, LayerCheck& check, Monitor& monitor) {
  for (;;) {
    monitor.check(0.7, kChoosing);
    check.measureBeside();
    const std::vector<LayerCheck::Fault> faults = check.columnsToLower(allColumns(columns));
    if (faults.empty()) return;
    lower(columns, faults);
  }
}

/// Where a cell or face would break a limit, looks for another shape, and takes layers away when there is
/// none, until no limit is broken; in the end gives back what can be.
void lowerUntilValid(PolyMesh& mesh, LayerColumns& columns, LayerPoints& points, const WallSight& sight,
                     const BoundaryRefineOptions& options, Monitor& monitor) {
  LayerCheck check(mesh, columns, points.all(), options.limits);
  std::vector<Id> changed = allColumns(columns);
  std::vector<PlannedLayers> planned;
  for (Id c : changed) planned.push_back({columns.layers(c), columns.reason(c)});
  const double all = static_cast<double>(changed.size()) + 1;
  std::vector<LayerCheck::Fault> faults = check.columnsToLower(changed);
  // Columns beside those with faults may get some when layers end there.
  LayerSearch search(mesh, columns, points, sight, check, options.limits, touched(columns, columnsOf(faults)),
                     monitor);
  search.moveLowerEnds(options.makeRoom);
  while (!faults.empty()) {
    for (int round = 0; round < kRounds; ++round) {
      monitor.check(0.1 + 0.6 * (1 - static_cast<double>(changed.size()) / all), kChoosing);
      const std::vector<Id> mended = search.mend(columnsOf(faults));
      if (mended.empty()) break;
      changed = columnsOf(faults);
      changed.insert(changed.end(), mended.begin(), mended.end());
      sortUnique(changed);
      faults = check.columnsToLower(touched(columns, changed));
    }
    changed = touched(columns, lower(columns, faults));
    faults = check.columnsToLower(changed);
  }
  raiseAgain(columns, points, check, planned, monitor);
  lowerBesideCells(columns, check, monitor);
}

}  // namespace

PolyMesh boundaryRefine(PolyMesh mesh, const BoundaryRefineOptions& options, Monitor& monitor,
                        BoundaryRefineReport* report) {
  checkMesh(mesh);
  const LayerDemands demands(mesh, options, options.patches, options.flow);
  monitor.check(0, "finding prisms");
  const bool splits = demands.mostLayers() > 1;
  if (splits) mesh = splitCutColumns(mesh, options.limits, monitor);
  LayerColumns columns(mesh);
  const WallSight sight(mesh);
  if (splits && options.makeRoom) {
    std::vector<double> behind;
    if (options.end == LayerEnd::EvenGrowth) behind = sizesBehind(mesh, columns);
    const std::vector<double> lengths = wantedLengths(
        mesh, columns, demands, edgeHeights(mesh, columns, demands, LayerEnd::LastFills), behind);
    makeLayerRoom(mesh, columns, sight, lengths, options.limits, monitor);
  }
  const std::vector<EdgeHeights> heights = edgeHeights(mesh, columns, demands, options.end);
  planLayers(mesh, columns, demands, heights);
  warnOfAspect(mesh, columns, heights, monitor);
  LayerPoints points(mesh, columns, sight, heights);
  if (splits) lowerUntilValid(mesh, columns, points, sight, options, monitor);
  monitor.check(0.7, "splitting prisms");
  PolyMesh refined = splitLayers(mesh, columns, points.all());
  if (report) *report = coverage(refined, columns, demands);
  monitor.check(1, "splitting prisms");
  return refined;
}

}  // namespace pm
