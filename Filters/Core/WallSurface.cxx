// SPDX-License-Identifier: BSD-3-Clause
#include "WallSurface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "SortedRows.h"

namespace pm {
namespace {

void numberNodes(const PolyMesh& mesh, const std::vector<Id>& wallFaces, WallSurface& wall) {
  wall.rowOf.assign(mesh.points.size(), kNone);
  for (Id f : wallFaces)
    for (Id p : mesh.faces[f]) wall.rowOf[p] = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (wall.rowOf[p] == 0) {
      wall.rowOf[p] = wall.size();
      wall.nodes.push_back(static_cast<Id>(p));
    }
}

/// Turns counts stored at offsets[i + 1] into offsets.
void sumUp(std::vector<Id>& offsets) {
  for (std::size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
}

void joinFaces(const PolyMesh& mesh, const std::vector<Id>& wallFaces, WallSurface& wall) {
  wall.faces.offsets.assign(wall.nodes.size() + 1, 0);
  for (Id f : wallFaces)
    for (Id p : mesh.faces[f]) ++wall.faces.offsets[wall.rowOf[p] + 1];
  sumUp(wall.faces.offsets);
  wall.faces.values.resize(wall.faces.offsets.back());
  std::vector<Id> next(wall.faces.offsets.begin(), wall.faces.offsets.end() - 1);
  for (Id f : wallFaces)
    for (Id p : mesh.faces[f]) wall.faces.values[next[wall.rowOf[p]]++] = f;
}

/// The rows before and after a node on the faces around it.
void joinNodes(const PolyMesh& mesh, WallSurface& wall) {
  wall.neighbours = sortedRows(wall.size(), [&](Id i, std::vector<Id>& beside) {
    for (Id f : wall.faces[i]) {
      const Span<Id> row = mesh.faces[f];
      const std::size_t k = std::find(row.begin(), row.end(), wall.nodes[i]) - row.begin(), n = row.size();
      beside.push_back(wall.rowOf[row[(k + 1) % n]]);
      beside.push_back(wall.rowOf[row[(k + n - 1) % n]]);
    }
  });
}

void measureScales(const PolyMesh& mesh, WallSurface& wall) {
  std::vector<double> own(wall.nodes.size());
  wall.scale.resize(wall.nodes.size());
  const tbb::blocked_range<Id> all(0, wall.size(), 1024);
  tbb::parallel_for(all, [&](const tbb::blocked_range<Id>& range) {
    for (Id i = range.begin(); i != range.end(); ++i) {
      double sum = 0;
      for (Id j : wall.neighbours[i]) sum += (mesh.points[wall.nodes[i]] - mesh.points[wall.nodes[j]]).norm();
      own[i] = sum / static_cast<double>(wall.neighbours[i].size());
    }
  });
  // One averaging: where projection has crowded nodes, their own edges alone would understate the scale.
  tbb::parallel_for(all, [&](const tbb::blocked_range<Id>& range) {
    for (Id i = range.begin(); i != range.end(); ++i) {
      double sum = own[i];
      for (Id j : wall.neighbours[i]) sum += own[j];
      wall.scale[i] = sum / static_cast<double>(wall.neighbours[i].size() + 1);
    }
  });
}

}  // namespace

WallSurface wallSurface(const PolyMesh& mesh) {
  WallSurface wall;
  std::vector<Id> wallFaces;
  for (Id b = 0; b < mesh.boundaryFaces(); ++b)
    if (mesh.isWallPatch(mesh.patch[b])) wallFaces.push_back(mesh.internalFaces() + b);
  numberNodes(mesh, wallFaces, wall);
  joinFaces(mesh, wallFaces, wall);
  joinNodes(mesh, wall);
  measureScales(mesh, wall);
  return wall;
}

}  // namespace pm
