// SPDX-License-Identifier: BSD-3-Clause
#include "BoundaryRefine.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "LayerCheck.h"
#include "LayerColumns.h"

namespace pm {
namespace {

constexpr int kMostLayers = 100;
const char* const kChoosing = "choosing layers";

void checkOptions(const PolyMesh& mesh, const BoundaryRefineOptions& options) {
  if (options.layers < 1 || options.layers > kMostLayers) {
    throw InputError(fmt::format("The number of layers is {}; give 1 to {}.", options.layers, kMostLayers));
  }
  if (!(options.expansion > 0) || !std::isfinite(options.expansion)) {
    throw InputError(fmt::format("The expansion ratio is {}; give a positive number.", options.expansion));
  }
  if (!(options.firstHeight >= 0) || !std::isfinite(options.firstHeight)) {
    throw InputError(
        fmt::format("The first height is {}; give a length, or 0 to have it follow from the number of "
                    "layers and the expansion ratio.",
                    options.firstHeight));
  }
  if (mesh.stage < Stage::Layer || mesh.base.size() != mesh.points.size()) {
    throw InputError("The mesh has no prismatic layer to refine; apply DummyLayer and Project first.");
  }
  if (mesh.stage == Stage::Refined) {
    throw InputError("The mesh has its boundary layers already; refine the mesh of the stage before.");
  }
}

/// Distances of the layers' ends from the wall, for a first height of 1: at [i] the sum of i layers.
std::vector<double> unitHeights(const BoundaryRefineOptions& options) {
  std::vector<double> sums(1, 0.0);
  double height = 1;
  for (int i = 0; i < options.layers; ++i) {
    sums.push_back(sums.back() + height);
    height *= options.expansion;
  }
  return sums;
}

Vec3 alongEdge(const PolyMesh& mesh, const LayerColumns& columns, Id lower) {
  return mesh.points[lower] - mesh.points[columns.wallPoint(lower)];
}

/// Area vector of a column's wall, out of the mesh.
Vec3 roofArea(const PolyMesh& mesh, const LayerColumns& columns, Id column) {
  Vec3 sum = Vec3::Zero();
  for (Id f : columns.roof(column)) sum += measureFace(mesh.points, mesh.faces[f], true).normal;
  return sum;
}

/// Length along each edge for one unit of height above the wall: edges lean where the wall bends.
std::vector<double> edgeSlants(const PolyMesh& mesh, const LayerColumns& columns) {
  constexpr double kLeast =
      0.4;  // below, the edge is too oblique for a height above the wall to have a meaning
  std::vector<double> cosines(mesh.points.size(), 0.0);
  std::vector<Id> counts(mesh.points.size(), 0);
  for (Id c = 0; c < columns.count(); ++c) {
    if (!columns.canSplit(c)) continue;
    const Vec3 inward = -roofArea(mesh, columns, c).normalized();
    for (Id b : columns.ring(c)) {
      cosines[b] += inward.dot(alongEdge(mesh, columns, b).normalized());
      ++counts[b];
    }
  }
  for (std::size_t b = 0; b < cosines.size(); ++b) {
    if (counts[b] > 0) cosines[b] = 1 / std::clamp(cosines[b] / counts[b], kLeast, 1.0);
  }
  return cosines;
}

/// Height of the first layer measured along each edge; 0 where there is no edge.
std::vector<double> firstLengths(const PolyMesh& mesh, const LayerColumns& columns,
                                 const BoundaryRefineOptions& options, const std::vector<double>& sums) {
  std::vector<double> first(mesh.points.size(), 0.0);
  if (options.firstHeight > 0) {
    first = edgeSlants(mesh, columns);
    for (double& length : first) length *= options.firstHeight;
    return first;
  }
  for (std::size_t b = 0; b < first.size(); ++b) {
    const Id lower = static_cast<Id>(b);
    if (columns.wallPoint(lower) >= 0) first[b] = alongEdge(mesh, columns, lower).norm() / sums.back();
  }
  return first;
}

/// Most layers that fit on an edge with the last at least as high as the one before it.
Id fittingLayers(double length, double first, const BoundaryRefineOptions& options,
                 const std::vector<double>& sums) {
  if (!(length > 0)) return 1;
  if (options.firstHeight == 0) return options.layers;
  Id layers = 1;
  while (layers < options.layers && length >= first * (2 * sums[layers] - sums[layers - 1])) ++layers;
  return layers;
}

/// Lowers columns until those side by side differ by one layer at most; returns all that changed, ascending.
std::vector<Id> grade(LayerColumns& columns, std::vector<Id> changed) {
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const Id most = columns.layers(changed[i]) + 1;
    columns.forEachBeside(changed[i], [&](Id other) {
      if (columns.layers(other) <= most) return;
      columns.setLayers(other, most);
      changed.push_back(other);
    });
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

/// checkMesh fails cells of an aspect ratio above 1000, which thin layers on large faces may reach.
void warnOfAspect(const PolyMesh& mesh, const LayerColumns& columns, const std::vector<double>& first,
                  Monitor& monitor) {
  constexpr double kMostAspect = 1000;
  double widest = 0;
  for (Id c = 0; c < columns.count(); ++c) {
    if (columns.layers(c) == 1) continue;
    const double area = roofArea(mesh, columns, c).norm();
    for (Id b : columns.ring(c)) widest = std::max(widest, std::sqrt(area) / first[b]);
  }
  if (widest <= kMostAspect) return;
  monitor.warning(
      fmt::format("Cells at the wall are up to {:.0f} times as wide as high; OpenFOAM's checkMesh "
                  "complains above {:.0f}. Use smaller cells at the wall or a larger first height.",
                  widest, kMostAspect));
}

/// The layers wished for, as far as they fit, graded; and the points for them behind the mesh's own.
std::vector<Vec3> planLayers(const PolyMesh& mesh, LayerColumns& columns,
                             const BoundaryRefineOptions& options, Monitor& monitor) {
  const std::vector<double> sums = unitHeights(options);
  const std::vector<double> first = firstLengths(mesh, columns, options, sums);
  std::vector<Id> all(columns.count());
  std::iota(all.begin(), all.end(), 0);
  for (Id c : all) {
    if (!columns.canSplit(c)) continue;
    Id layers = options.layers;
    for (Id b : columns.ring(c)) {
      layers = std::min(layers, fittingLayers(alongEdge(mesh, columns, b).norm(), first[b], options, sums));
    }
    columns.setLayers(c, layers);
  }
  grade(columns, all);
  columns.updateEdges(all);
  warnOfAspect(mesh, columns, first, monitor);
  const Id oldPoints = static_cast<Id>(mesh.points.size());
  std::vector<Vec3> points = mesh.points;
  points.resize(columns.numberPoints(oldPoints));
  for (Id b = 0; b < oldPoints; ++b) {
    const Id inner = columns.edgeLayers(b) - 1;
    if (inner == 0) continue;
    const Vec3 edge = alongEdge(mesh, columns, b);
    const double unit = first[b] / edge.norm();
    for (Id i = 0; i < inner; ++i) {
      points[columns.firstPoint(b) + i] = mesh.points[columns.wallPoint(b)] + unit * sums[i + 1] * edge;
    }
  }
  return points;
}

/// Faces between layers are whole where they are flat enough: their parts would be skew between thin layers.
void partFoldedCaps(LayerColumns& columns, const std::vector<Vec3>& points, const QualityLimits& limits) {
  std::vector<Id> row;
  for (Id c = 0; c < columns.count(); ++c) {
    if (columns.roof(c).size() < 2) continue;
    for (Id level = 1; level < columns.layers(c); ++level) {
      columns.capRow(c, level, 0, row);
      const FaceMeasures cap = measureFace(points, {row.data(), row.data() + row.size()});
      if (cap.warpage() <= limits.maxWarpage && cap.eta >= limits.minEtaInternal) continue;
      columns.partCaps(c);
      break;
    }
  }
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

/// Takes layers away where a cell or face would break a limit, until none does.
void lowerUntilValid(const PolyMesh& mesh, LayerColumns& columns, const std::vector<Vec3>& points,
                     const QualityLimits& limits, Monitor& monitor) {
  LayerCheck check(mesh, columns, points, limits);
  std::vector<Id> changed(columns.count());
  std::iota(changed.begin(), changed.end(), 0);
  const double all = static_cast<double>(changed.size()) + 1;
  while (!changed.empty()) {
    monitor.check(0.1 + 0.6 * (1 - static_cast<double>(changed.size()) / all), kChoosing);
    const std::vector<Id> lower = check.columnsToLower(changed);
    for (Id c : lower) columns.setLayers(c, columns.layers(c) - 1);
    const std::vector<Id> graded = grade(columns, lower);
    columns.updateEdges(graded);
    changed = touched(columns, graded);
  }
}

/// Puts the chosen layers into a mesh.
class Splitter {
 public:
  Splitter(const PolyMesh& mesh, LayerColumns& columns) : mesh_(mesh), columns_(columns) {}

  PolyMesh split(const std::vector<Vec3>& candidates) {
    numberCells();
    copyPoints(candidates);
    copyCells();
    splitFaces();
    out_.patchNames = mesh_.patchNames;
    out_.patchTypes = mesh_.patchTypes;
    out_.finestSize = mesh_.finestSize;
    out_.stage = Stage::Refined;
    canonicalise(out_);
    return std::move(out_);
  }

 private:
  /// Layer 1 keeps the column's cell; the others are appended, column by column.
  void numberCells() {
    nextCell_.assign(1, mesh_.cellCount);
    for (Id c = 0; c < columns_.count(); ++c) nextCell_.push_back(nextCell_.back() + columns_.layers(c) - 1);
    out_.cellCount = nextCell_.back();
  }
  Id cellAt(Id cell, Id layer) const {
    return layer == 1 ? cell : nextCell_[columns_.columnOf(cell)] + layer - 2;
  }

  /// candidates hold points of edges that have lost layers since; those that are left move up.
  void copyPoints(const std::vector<Vec3>& candidates) {
    const Id old = static_cast<Id>(mesh_.points.size());
    std::vector<Id> from(old);
    for (Id b = 0; b < old; ++b) from[b] = columns_.firstPoint(b);
    const Id count = columns_.numberPoints(old);
    out_.points = mesh_.points;
    out_.fixed = mesh_.fixed;
    out_.base = mesh_.base;
    out_.points.resize(count);
    out_.fixed.resize(count, 0);
    out_.base.resize(count, kNone);
    for (Id b = 0; b < old; ++b) {
      const Id inner = columns_.edgeLayers(b) - 1;
      if (inner == 0) continue;
      const Id wall = columns_.wallPoint(b), to = columns_.firstPoint(b);
      for (Id i = 0; i < inner; ++i) {
        out_.points[to + i] = candidates[from[b] + i];
        out_.fixed[to + i] = mesh_.fixed[wall] & mesh_.fixed[b];
      }
      if (mesh_.base[wall] == b) out_.base[wall] = to;
    }
  }

  void copyCells() {
    out_.level = mesh_.level;
    out_.layer = mesh_.layer;
    out_.level.resize(out_.cellCount);
    out_.layer.resize(out_.cellCount);
    out_.zone = mesh_.zone;
    out_.zoneNames = mesh_.zoneNames;
    if (!out_.zone.empty()) out_.zone.resize(out_.cellCount);
    for (Id c = 0; c < columns_.count(); ++c) {
      const Id cell = columns_.cell(c);
      for (Id layer = 2; layer <= columns_.layers(c); ++layer) {
        out_.level[cellAt(cell, layer)] = mesh_.level[cell];
        out_.layer[cellAt(cell, layer)] = static_cast<std::uint8_t>(layer);
        if (!out_.zone.empty()) out_.zone[cellAt(cell, layer)] = mesh_.zone[cell];
      }
    }
  }

  /// A source of faces: an internal face, a column's caps, or a boundary face, in this order.
  Id sources() const { return mesh_.faceCount() + columns_.count(); }
  Id facesFrom(Id source) const {
    const Id internal = mesh_.internalFaces();
    if (source < internal) return columns_.pieces(source);
    if (source < internal + columns_.count())
      return (columns_.layers(source - internal) - 1) * columns_.capParts(source - internal);
    return columns_.pieces(source - columns_.count());
  }
  /// The k-th face (from 1) of a source.
  void makeFace(Id source, Id k, std::vector<Id>& row, Id& owner, Id& neighbour) const {
    const Id internal = mesh_.internalFaces();
    if (source >= internal && source < internal + columns_.count()) {
      const Id column = source - internal;
      const Id parts = columns_.capParts(column), level = (k - 1) / parts + 1;
      columns_.capRow(column, level, (k - 1) % parts, row);
      owner = cellAt(columns_.cell(column), level + 1);
      neighbour = cellAt(columns_.cell(column), level);
      return;
    }
    const Id face = source < internal ? source : source - columns_.count();
    columns_.pieceRow(face, k, row);
    owner = cellAt(mesh_.owner[face], columns_.layerAt(mesh_.owner[face], face, k));
    if (face >= internal) return;
    neighbour = cellAt(mesh_.neighbour[face], columns_.layerAt(mesh_.neighbour[face], face, k));
  }

  template <class Body>
  void forEachFace(const std::vector<Id>& start, const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<Id>(0, sources(), 1024), [&](const tbb::blocked_range<Id>& range) {
      std::vector<Id> row;
      for (Id source = range.begin(); source != range.end(); ++source) {
        for (Id f = start[source]; f < start[source + 1]; ++f) {
          Id owner = kNone, neighbour = kNone;
          makeFace(source, f - start[source] + 1, row, owner, neighbour);
          body(f, row, owner, neighbour, source);
        }
      }
    });
  }

  void splitFaces() {
    std::vector<Id> start(1, 0);
    for (Id source = 0; source < sources(); ++source) start.push_back(start.back() + facesFrom(source));
    const Id faces = start.back(), internal = start[mesh_.internalFaces() + columns_.count()];
    out_.faces.offsets.assign(static_cast<std::size_t>(faces) + 1, 0);
    out_.owner.resize(faces);
    out_.neighbour.resize(internal);
    out_.patch.resize(faces - internal);
    const Id boundaryShift = mesh_.internalFaces() + columns_.count();
    forEachFace(start, [&](Id f, const std::vector<Id>& row, Id owner, Id neighbour, Id source) {
      out_.faces.offsets[f + 1] = static_cast<Id>(row.size());
      out_.owner[f] = owner;
      if (f < internal) {
        out_.neighbour[f] = neighbour;
      } else {
        out_.patch[f - internal] = mesh_.patch[source - boundaryShift];
      }
    });
    std::vector<Id>& offsets = out_.faces.offsets;
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    out_.faces.values.resize(offsets.back());
    forEachFace(start, [&](Id f, const std::vector<Id>& row, Id, Id, Id) {
      std::copy(row.begin(), row.end(), out_.faces.values.begin() + offsets[f]);
    });
  }

  const PolyMesh& mesh_;
  LayerColumns& columns_;
  PolyMesh out_;
  std::vector<Id> nextCell_;  // of each column: its cell of layer 2
};

BoundaryRefineReport countLayers(const PolyMesh& mesh, const LayerColumns& columns, int layers) {
  BoundaryRefineReport report;
  report.facesByLayers.assign(layers, 0);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    if (!mesh.isWallPatch(mesh.patch[i])) continue;
    ++report.wallFaces;
    ++report.facesByLayers[columns.layersOfCell(mesh.owner[mesh.internalFaces() + i]) - 1];
  }
  return report;
}

}  // namespace

PolyMesh boundaryRefine(const PolyMesh& mesh, const BoundaryRefineOptions& options, Monitor& monitor,
                        BoundaryRefineReport* report) {
  checkOptions(mesh, options);
  monitor.check(0, "finding prisms");
  LayerColumns columns(mesh);
  const std::vector<Vec3> points = planLayers(mesh, columns, options, monitor);
  partFoldedCaps(columns, points, options.limits);
  lowerUntilValid(mesh, columns, points, options.limits, monitor);
  if (report) *report = countLayers(mesh, columns, options.layers);
  monitor.check(0.7, "splitting prisms");
  PolyMesh refined = Splitter(mesh, columns).split(points);
  monitor.check(1, "splitting prisms");
  return refined;
}

}  // namespace pm
