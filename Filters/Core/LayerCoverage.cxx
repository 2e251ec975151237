// SPDX-License-Identifier: BSD-3-Clause
#include "LayerCoverage.h"

#include <algorithm>
#include <cmath>

#include "MeshQuality.h"

namespace pm {
namespace {

constexpr double kWithin = 0.2;  // of the wanted first height

/// Volumes of the layers' cells, 0 for others.
std::vector<double> layerVolumes(const PolyMesh& mesh) {
  std::vector<double> volumes(mesh.cellCount, 0.0);
  std::vector<Id> origin(mesh.cellCount, kNone);  // a point of the cell, so that a far model costs no digits
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Id own = mesh.owner[f], next = f < mesh.internalFaces() ? mesh.neighbour[f] : own;
    if (mesh.layer[own] == 0 && mesh.layer[next] == 0) continue;
    const FaceMeasures m = measureFace(mesh.points, mesh.faces[f], true);
    const auto add = [&](Id cell, double sign) {
      if (origin[cell] == kNone) origin[cell] = mesh.faces[f][0];
      volumes[cell] += sign * m.normal.dot(m.centre - mesh.points[origin[cell]]) / 3;
    };
    add(own, 1);
    if (next != own) add(next, -1);
  }
  return volumes;
}

/// Volume of all layers of each column. Those behind the wall's are the refined mesh's last cells.
std::vector<double> columnVolumes(const LayerColumns& columns, const std::vector<double>& volumes) {
  std::vector<double> sums(columns.count(), 0.0);
  Id behind = static_cast<Id>(volumes.size());
  for (Id c = columns.count() - 1; c >= 0; --c) {
    sums[c] = volumes[columns.cell(c)];
    for (Id layer = 2; layer <= columns.layers(c); ++layer) sums[c] += volumes[--behind];
  }
  return sums;
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
    return mean;
  }
  Id faces() const { return sum_.faces; }

 private:
  PatchCoverage sum_;
};

}  // namespace

BoundaryRefineReport coverage(const PolyMesh& refined, const LayerColumns& columns,
                              const LayerDemands& demands) {
  const Id count = refined.boundaryFaces(), internal = refined.internalFaces();
  const std::vector<double> volumes = layerVolumes(refined), ofColumn = columnVolumes(columns, volumes);
  std::vector<double> areas(count, 0.0), wallArea(refined.cellCount, 0.0);
  for (Id i = 0; i < count; ++i) {
    areas[i] = measureFace(refined.points, refined.faces[internal + i], true).normal.norm();
    if (refined.isWallPatch(refined.patch[i])) wallArea[refined.owner[internal + i]] += areas[i];
  }
  BoundaryRefineReport report;
  report.facesByLayers.assign(demands.mostLayers(), 0);
  WallFaceLayers& faces = report.faces;
  faces.layers.assign(count, 0);
  faces.reason.assign(count, LayerReason::None);
  for (auto* heights : {&faces.firstHeight, &faces.wantedFirst, &faces.thickness}) heights->assign(count, 0);
  std::vector<Summing> sums(refined.patchNames.begin(), refined.patchNames.end());
  Summing all("all walls");
  for (Id i = 0; i < count; ++i) {
    if (!refined.isWallPatch(refined.patch[i])) continue;
    const Id cell = refined.owner[internal + i], column = columns.columnOf(cell);
    const LayerDemand& demand = demands.of(refined.patch[i]);
    const double area = wallArea[cell];
    faces.layers[i] = static_cast<std::uint8_t>(columns.layersOfCell(cell));
    faces.reason[i] = column == kNone ? LayerReason::NoPrism : columns.reason(column);
    faces.firstHeight[i] = area > 0 ? volumes[cell] / area : 0;
    faces.thickness[i] = area > 0 && column != kNone ? ofColumn[column] / area : faces.firstHeight[i];
    faces.wantedFirst[i] = demand.first > 0
                               ? demand.first
                               : faces.thickness[i] / EdgeHeights{1, demand.expansion, 0}.sum(demand.layers);
    ++report.wallFaces;
    ++report.facesByLayers[faces.layers[i] - 1];
    for (Summing* sum : {&sums[refined.patch[i]], &all}) sum->add(faces, i, demand.layers, areas[i]);
  }
  for (const Summing& sum : sums)
    if (sum.faces() > 0) report.patches.push_back(sum.result());
  if (report.patches.size() > 1) report.patches.push_back(all.result());
  return report;
}

}  // namespace pm
