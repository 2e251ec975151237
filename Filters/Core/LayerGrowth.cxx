// SPDX-License-Identifier: BSD-3-Clause
#include "LayerGrowth.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "MeshQuality.h"

namespace pm {

LayerCells measureLayerCells(const PolyMesh& mesh) {
  const auto cellsOf = [&](Id f) {
    return std::pair(mesh.owner[f], f < mesh.internalFaces() ? mesh.neighbour[f] : mesh.owner[f]);
  };
  std::vector<std::uint8_t> wanted(mesh.cellCount, 0);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const auto [own, next] = cellsOf(f);
    if (mesh.layer[own] > 0 || mesh.layer[next] > 0) wanted[own] = wanted[next] = 1;
  }
  std::vector<Id> faces;
  std::vector<Id> origin(mesh.cellCount, kNone);  // a point of the cell, so that a far model costs no digits
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const auto [own, next] = cellsOf(f);
    if (!wanted[own] && !wanted[next]) continue;
    faces.push_back(f);
    for (Id cell : {own, next})
      if (origin[cell] == kNone) origin[cell] = mesh.faces[f][0];
  }
  LayerCells cells;
  cells.volumes.assign(mesh.cellCount, 0.0);
  cells.centres.assign(mesh.cellCount, Vec3::Zero());
  // Measured in parallel, added up in their order.
  constexpr std::size_t kBlock = 1 << 15;
  std::vector<FaceMeasures> measures(std::min(kBlock, faces.size()));
  for (std::size_t first = 0; first < faces.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, faces.size() - first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 512), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        measures[i] = measureFace(mesh.points, mesh.faces[faces[first + i]], true);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const auto [own, next] = cellsOf(faces[first + i]);
      const auto add = [&](Id cell, double sign) {
        const Vec3 at = measures[i].centre - mesh.points[origin[cell]];
        const double pyramid = sign * measures[i].normal.dot(at) / 3;
        cells.volumes[cell] += pyramid;
        cells.centres[cell] += 0.75 * pyramid * at;
      };
      add(own, 1);
      if (next != own) add(next, -1);
    }
  }
  for (Id c = 0; c < mesh.cellCount; ++c) {
    if (!wanted[c] || !(cells.volumes[c] > 0)) continue;
    cells.centres[c] = mesh.points[origin[c]] + cells.centres[c] / cells.volumes[c];
  }
  return cells;
}

std::vector<Id> columnsOfCells(const PolyMesh& refined, const LayerColumns& columns) {
  std::vector<Id> ofCell(refined.cellCount, kNone);
  Id behind = refined.cellCount;  // the layers behind the wall's are the last cells, column by column
  for (Id c = columns.count() - 1; c >= 0; --c) {
    ofCell[columns.cell(c)] = c;
    for (Id layer = 2; layer <= columns.layers(c); ++layer) ofCell[--behind] = c;
  }
  return ofCell;
}

LayerGrowth layerGrowth(const PolyMesh& mesh, const LayerColumns& columns, const LayerCells& cells) {
  const std::vector<Id> ofCell = columnsOfCells(mesh, columns);
  std::vector<double> near(columns.count(), 0.0), far(columns.count(), 0.0);  // of the faces behind, by area
  LayerGrowth growth;
  growth.inside.assign(columns.count(), 0.0);
  growth.outside.assign(columns.count(), 0.0);
  const auto isBehind = [&](Id f) {
    const Span<Id> row = mesh.faces[f];
    return std::all_of(row.begin(), row.end(),
                       [&](Id p) { return p < columns.pointCount() && mesh.base[p] == kNone; });
  };
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    const Id own = mesh.owner[f], next = mesh.neighbour[f];
    if (ofCell[own] == kNone && ofCell[next] == kNone) continue;
    const bool isCap = ofCell[own] == ofCell[next];
    if (!isCap && !isBehind(f)) continue;
    const FaceMeasures face = measureFace(mesh.points, mesh.faces[f], true);
    const double ownHeight = face.normal.dot(face.centre - cells.centres[own]);
    const double nextHeight = face.normal.dot(cells.centres[next] - face.centre);
    if (isCap) {
      const bool ownIsNear = mesh.layer[own] < mesh.layer[next];
      const double ratio = ownIsNear ? nextHeight / ownHeight : ownHeight / nextHeight;
      double& most = growth.inside[ofCell[own]];
      most = std::max(most, ratio);
      continue;
    }
    const auto add = [&](Id cell, double height, double beyond) {
      const Id column = ofCell[cell];
      if (column == kNone || mesh.layer[cell] != columns.layers(column)) return;
      near[column] += height;
      far[column] += beyond;
    };
    add(own, ownHeight, nextHeight);
    add(next, nextHeight, ownHeight);
  }
  for (Id c = 0; c < columns.count(); ++c)
    if (near[c] > 0) growth.outside[c] = far[c] / near[c];
  return growth;
}

}  // namespace pm
