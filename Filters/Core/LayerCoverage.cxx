// SPDX-License-Identifier: BSD-3-Clause
#include "LayerCoverage.h"

#include <algorithm>
#include <cmath>

#include "LayerGrowth.h"
#include "MeshQuality.h"

namespace pm {
namespace {

constexpr double kWithin = 0.2;  // of the wanted first height
constexpr double kMost = 0.95;   // of the area

/// Heights of a column's first layer and of all its layers.
struct ColumnHeights {
  double first = 0, all = 0;
};

/// How far the inner end of a cell is above its wall, on average over the prism's edges.
ColumnHeights columnHeights(const PolyMesh& refined, const LayerColumns& columns, Id column,
                            const Vec3& outward) {
  std::vector<Id> ends(columns.ring(column).begin(), columns.ring(column).end()), firstEnds = ends;
  if (columns.layers(column) > 1) columns.capRow(column, 1, firstEnds);
  const auto height = [&](const std::vector<Id>& row) {
    double sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += outward.dot(refined.points[columns.wallPoint(ends[i])] - refined.points[row[i]]);
    return sum / static_cast<double>(row.size());
  };
  return {height(firstEnds), height(ends)};
}

/// The value that a share of the weight lies below. pairs: value and weight, in any order.
double quantile(std::vector<std::pair<double, double>> pairs, double share) {
  if (pairs.empty()) return 0;
  std::sort(pairs.begin(), pairs.end());
  double all = 0, sum = 0;
  for (const auto& [value, weight] : pairs) all += weight;
  for (const auto& [value, weight] : pairs)
    if ((sum += weight) >= share * all) return value;
  return pairs.back().first;
}

/// Adds up faces of a patch, then turns sums into means and shares.
class Summing {
 public:
  explicit Summing(std::string name) { sum_.name = std::move(name); }
  void add(const WallFaceLayers& faces, Id i, Id wantedLayers, double area) {
    ++sum_.faces;
    sum_.area += area;
    sum_.wantedLayers = std::max(sum_.wantedLayers, wantedLayers);
    sum_.layers += area * faces.layers[i];
    ++sum_.byReason[static_cast<int>(faces.reason[i])];
    sum_.thickness += area * faces.thickness[i];
    sum_.wantedFirst += area * faces.wantedFirst[i];
    if (faces.growthInside[i] > 0) inside_.emplace_back(faces.growthInside[i], area);
    if (faces.growthOutside[i] > 0) outside_.emplace_back(faces.growthOutside[i], area);
    if (faces.layers[i] >= wantedLayers) sum_.allLayers += area;
    if (faces.layers[i] < std::min<Id>(2, wantedLayers)) return;
    sum_.covered += area;
    const double got = faces.firstHeight[i], wanted = faces.wantedFirst[i];
    if (std::abs(got - wanted) <= kWithin * wanted) sum_.asWanted += area;
    sum_.meanFirst += area * got;
    sum_.minFirst = sum_.minFirst == 0 ? got : std::min(sum_.minFirst, got);
  }
  PatchCoverage result() const {
    PatchCoverage mean = sum_;
    const auto divide = [](double& value, double by) { value = by > 0 ? value / by : 0; };
    for (double* value : {&mean.asWanted, &mean.meanFirst}) divide(*value, sum_.covered);
    for (double* value : {&mean.layers, &mean.allLayers, &mean.covered, &mean.wantedFirst, &mean.thickness})
      divide(*value, sum_.area);
    mean.growthInside95 = quantile(inside_, kMost);
    mean.growthOutside = quantile(outside_, 0.5);
    mean.growthOutside95 = quantile(outside_, kMost);
    return mean;
  }
  Id faces() const { return sum_.faces; }

 private:
  PatchCoverage sum_;
  std::vector<std::pair<double, double>> inside_, outside_;  // growth and area of each face
};

/// What became of the layers above each wall face. areas: area vectors of the boundary faces.
WallFaceLayers wallFaceLayers(const PolyMesh& refined, const LayerColumns& columns,
                              const LayerDemands& demands, const std::vector<Vec3>& areas) {
  const Id count = refined.boundaryFaces(), internal = refined.internalFaces();
  const LayerCells cells = measureLayerCells(refined);
  const LayerGrowth growth = layerGrowth(refined, columns, cells);
  std::vector<Vec3> walls(refined.cellCount, Vec3::Zero());
  for (Id i = 0; i < count; ++i)
    if (refined.isWallPatch(refined.patch[i])) walls[refined.owner[internal + i]] += areas[i];
  WallFaceLayers faces;
  faces.layers.assign(count, 0);
  faces.reason.assign(count, LayerReason::None);
  for (auto* values :
       {&faces.firstHeight, &faces.wantedFirst, &faces.thickness, &faces.growthInside, &faces.growthOutside})
    values->assign(count, 0);
  for (Id i = 0; i < count; ++i) {
    if (!refined.isWallPatch(refined.patch[i])) continue;
    const Id cell = refined.owner[internal + i], column = columns.columnOf(cell);
    const LayerDemand& demand = demands.of(refined.patch[i]);
    const double area = walls[cell].norm(), meanHeight = area > 0 ? cells.volumes[cell] / area : 0;
    const bool isPrism = column != kNone && columns.canSplit(column);
    ColumnHeights heights{meanHeight, meanHeight};
    if (isPrism) {
      const ColumnHeights along = columnHeights(refined, columns, column, walls[cell].normalized());
      if (along.first > 0) heights = along;  // the edges of a folded wall may run along it in the mean
    }
    faces.layers[i] = static_cast<std::uint8_t>(columns.layersOfCell(cell));
    faces.reason[i] = column == kNone ? LayerReason::NoPrism : columns.reason(column);
    faces.firstHeight[i] = heights.first;
    faces.thickness[i] = heights.all;
    faces.wantedFirst[i] = demand.first > 0
                               ? demand.first
                               : heights.all / EdgeHeights{1, demand.expansion, 0}.sum(demand.layers);
    if (column == kNone) continue;
    faces.growthInside[i] = growth.inside[column];
    faces.growthOutside[i] = growth.outside[column];
  }
  return faces;
}

}  // namespace

BoundaryRefineReport coverage(const PolyMesh& refined, const LayerColumns& columns,
                              const LayerDemands& demands) {
  std::vector<Vec3> areas;
  for (Id f = refined.internalFaces(); f < refined.faceCount(); ++f)
    areas.push_back(measureFace(refined.points, refined.faces[f], true).normal);
  BoundaryRefineReport report;
  report.facesByLayers.assign(demands.mostLayers(), 0);
  report.faces = wallFaceLayers(refined, columns, demands, areas);
  std::vector<Summing> sums(refined.patchNames.begin(), refined.patchNames.end());
  Summing all("all walls");
  for (Id i = 0; i < refined.boundaryFaces(); ++i) {
    const Id patch = refined.patch[i];
    if (!refined.isWallPatch(patch)) continue;
    ++report.wallFaces;
    ++report.facesByLayers[report.faces.layers[i] - 1];
    for (Summing* sum : {&sums[patch], &all})
      sum->add(report.faces, i, demands.of(patch).layers, areas[i].norm());
  }
  for (const Summing& sum : sums)
    if (sum.faces() > 0) report.patches.push_back(sum.result());
  if (report.patches.size() > 1) report.patches.push_back(all.result());
  return report;
}

}  // namespace pm
