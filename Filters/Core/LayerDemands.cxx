// SPDX-License-Identifier: BSD-3-Clause
#include "LayerDemands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "LayerGrowth.h"
#include "MeshQuality.h"

namespace pm {
namespace {

constexpr int kMostLayers = 100;
constexpr double kLeastExpansion = 0.1, kMostExpansion = 10;

/// Does a name fit a pattern of characters, * and ?
bool fits(const std::string& pattern, const std::string& name) {
  std::size_t p = 0, n = 0, star = std::string::npos, resume = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string::npos) {  // let the last star take one more
      p = star + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string::npos;
}

/// Height of so many layers when the first is 1.
double unitSum(int layers, double expansion) { return EdgeHeights{1, expansion, 0}.sum(layers); }

void checkLength(double value, const char* what, const std::string& where) {
  if (value >= 0 && std::isfinite(value)) return;
  throw InputError(fmt::format(
      "The {}{} is {}; give a length, or 0 to have it follow from the other options.", what, where, value));
}

void checkSpec(const LayerSpec& spec, int leastLayers, const std::string& where) {
  if (spec.layers < leastLayers || spec.layers > kMostLayers) {
    throw InputError(fmt::format("The number of layers{} is {}; give {} to {}.", where, spec.layers,
                                 leastLayers, kMostLayers));
  }
  if (!(spec.expansion > 0) || !std::isfinite(spec.expansion)) {
    throw InputError(
        fmt::format("The expansion ratio{} is {}; give a positive number.", where, spec.expansion));
  }
  checkLength(spec.firstHeight, "first height", where);
  checkLength(spec.thickness, "thickness of the layers", where);
  if (!(spec.yPlus >= 0) || !std::isfinite(spec.yPlus)) {
    throw InputError(
        fmt::format("The y+{} is {}; give a positive number, or 0 for none.", where, spec.yPlus));
  }
  if (spec.yPlus > 0 && (spec.firstHeight > 0 || spec.thickness > 0)) {
    throw InputError(
        fmt::format("The y+{} says how high the first layer is; give it or lengths, not both.", where));
  }
}

/// The expansion with which layers of a first height 1 sum up to a height, by bisection; the nearest there
/// is.
double expansionFor(double height, int layers) {
  double low = kLeastExpansion, high = kMostExpansion;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (unitSum(layers, middle) < height ? low : high) = middle;
  }
  return low;
}

/// The expansion with which the layers grow from the first height to the thickness.
double expansionBetween(const LayerSpec& spec, const std::string& where) {
  const double wanted = spec.thickness / spec.firstHeight;
  const bool possible = spec.layers > 1 && wanted >= unitSum(spec.layers, kLeastExpansion) &&
                        wanted <= unitSum(spec.layers, kMostExpansion);
  if (possible) return expansionFor(wanted, spec.layers);
  throw InputError(
      fmt::format("{} layer{} cannot grow from a first height of {:g} to a thickness of {:g}{}; change one "
                  "of the three, or leave "
                  "out the height or the thickness.",
                  spec.layers, spec.layers == 1 ? "" : "s", spec.firstHeight, spec.thickness, where));
}

LayerDemand demandOf(const LayerSpec& spec, const FlowData& flow, int leastLayers, const std::string& where) {
  checkSpec(spec, leastLayers, where);
  LayerDemand demand;
  demand.layers = std::max(1, spec.layers);
  demand.expansion = spec.expansion;
  demand.first = spec.yPlus > 0 ? flatPlateHeight(spec.yPlus, flow) : spec.firstHeight;
  if (spec.thickness > 0 && spec.firstHeight > 0)
    demand.expansion = expansionBetween(spec, where);
  else if (spec.thickness > 0)
    demand.first = spec.thickness / unitSum(demand.layers, spec.expansion);
  return demand;
}

Vec3 alongEdge(const PolyMesh& mesh, const LayerColumns& columns, Id lower) {
  return mesh.points[lower] - mesh.points[columns.wallPoint(lower)];
}

/// Length along each edge for one unit of height above the wall.
std::vector<double> edgeSlants(const PolyMesh& mesh, const LayerColumns& columns) {
  constexpr double kLeast =
      0.4;  // below, the edge is too oblique for a height above the wall to have a meaning
  std::vector<double> cosines(mesh.points.size(), 0.0);
  std::vector<Id> counts(mesh.points.size(), 0);
  for (Id c = 0; c < columns.count(); ++c) {
    if (!columns.canSplit(c)) continue;
    Vec3 outward = Vec3::Zero();
    for (Id f : columns.roof(c)) outward += measureFace(mesh.points, mesh.faces[f], true).normal;
    const Vec3 inward = -outward.normalized();
    for (Id b : columns.ring(c)) {
      cosines[b] += inward.dot(alongEdge(mesh, columns, b).normalized());
      ++counts[b];
    }
  }
  for (std::size_t b = 0; b < cosines.size(); ++b)
    cosines[b] = counts[b] > 0 ? 1 / std::clamp(cosines[b] / counts[b], kLeast, 1.0) : 1;
  return cosines;
}

}  // namespace

double flatPlateHeight(double yPlus, const FlowData& flow) {
  for (const double value : {flow.speed, flow.length, flow.viscosity}) {
    if (value > 0 && std::isfinite(value)) continue;
    throw InputError(
        "A y+ needs the flow: give its speed, the length over which the layer grows and the kinematic "
        "viscosity, each "
        "larger than zero.");
  }
  constexpr double kTransition = 5e5;
  const double reynolds = flow.speed * flow.length / flow.viscosity;
  const double friction =
      reynolds <= kTransition ? 0.664 / std::sqrt(reynolds) : 0.026 / std::pow(reynolds, 1.0 / 7);
  return 2 * yPlus * flow.viscosity / (flow.speed * std::sqrt(friction / 2));
}

LayerDemands::LayerDemands(const PolyMesh& mesh, const LayerSpec& everywhere,
                           const std::vector<PatchLayers>& patches, const FlowData& flow) {
  ofPatch_.assign(mesh.patchNames.size(), demandOf(everywhere, flow, 1, ""));
  for (const PatchLayers& own : patches) {
    const LayerDemand demand = demandOf(own.spec, flow, 0, fmt::format(" of patches '{}'", own.patches));
    bool found = false;
    for (std::size_t i = 0; i < ofPatch_.size(); ++i) {
      if (!mesh.isWallPatch(static_cast<Id>(i)) || !fits(own.patches, mesh.patchNames[i])) continue;
      ofPatch_[i] = demand;
      found = true;
    }
    if (!found) {
      throw InputError(
          fmt::format("No wall is named like '{}', for which layers are given; * stands for any characters.",
                      own.patches));
    }
  }
}

Id LayerDemands::mostLayers() const {
  Id most = 1;
  for (const LayerDemand& demand : ofPatch_) most = std::max(most, demand.layers);
  return most;
}

const LayerDemand& LayerDemands::ofColumn(const PolyMesh& mesh, const LayerColumns& columns,
                                          Id column) const {
  const auto patchOf = [&](Id face) { return mesh.patch[face - mesh.internalFaces()]; };
  const Span<Id> roof = columns.roof(column);
  const LayerDemand* most = &of(patchOf(roof[0]));
  for (Id f : roof)
    if (of(patchOf(f)).layers > most->layers) most = &of(patchOf(f));
  return *most;
}

std::vector<EdgeHeights> edgeHeights(const PolyMesh& mesh, const LayerColumns& columns,
                                     const LayerDemands& demands, LayerEnd end) {
  const std::vector<double> slants = edgeSlants(mesh, columns);
  std::vector<EdgeHeights> heights(mesh.points.size());
  for (Id c = 0; c < columns.count(); ++c) {
    if (!columns.canSplit(c)) continue;
    const LayerDemand& demand = demands.ofColumn(mesh, columns, c);
    if (demand.layers == 1) continue;
    for (Id b : columns.ring(c)) {
      const double length = alongEdge(mesh, columns, b).norm();
      const double first =
          demand.first > 0 ? demand.first * slants[b] : length / unitSum(demand.layers, demand.expansion);
      if (heights[b].first > 0 && heights[b].first <= first) continue;
      heights[b] = {first, demand.expansion, demand.first > 0 ? 0 : length};
      if (end == LayerEnd::EvenGrowth && length > heights[b].sum(demand.layers))
        heights[b].expansion = expansionFor(length / first, demand.layers);
    }
  }
  return heights;
}

std::vector<double> sizesBehind(const PolyMesh& mesh, const LayerColumns& columns) {
  const LayerCells cells = measureLayerCells(mesh);
  std::vector<double> sizes(mesh.points.size(), 0.0);
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    const Id own = mesh.owner[f], next = mesh.neighbour[f];
    const bool ownIsColumn = columns.columnOf(own) != kNone;
    if (ownIsColumn == (columns.columnOf(next) != kNone)) continue;
    const double size = std::cbrt(std::max(0.0, cells.volumes[ownIsColumn ? next : own]));
    for (Id p : mesh.faces[f])
      if (columns.wallPoint(p) >= 0) sizes[p] = sizes[p] > 0 ? std::min(sizes[p], size) : size;
  }
  return sizes;
}

std::vector<double> wantedLengths(const PolyMesh& mesh, const LayerColumns& columns,
                                  const LayerDemands& demands, const std::vector<EdgeHeights>& heights,
                                  const std::vector<double>& behind) {
  std::vector<double> lengths(mesh.points.size(), 0.0);
  for (Id c = 0; c < columns.count(); ++c) {
    if (!columns.canSplit(c)) continue;
    const LayerDemand& demand = demands.ofColumn(mesh, columns, c);
    if (demand.layers == 1) continue;
    for (Id b : columns.ring(c)) {
      if (demand.first > 0) lengths[b] = std::max(lengths[b], heights[b].sum(demand.layers));
      if (behind.empty() || !(behind[b] > 0)) continue;
      const double both = alongEdge(mesh, columns, b).norm() + behind[b], first = heights[b].first;
      const double ratio = demand.first > 0
                               ? std::max(demand.expansion, expansionFor(both / first, demand.layers + 1))
                               : demand.expansion;
      const double even = both * unitSum(demand.layers, ratio) / unitSum(demand.layers + 1, ratio);
      lengths[b] = std::max(lengths[b], even);
    }
  }
  return lengths;
}

}  // namespace pm
