// SPDX-License-Identifier: BSD-3-Clause
#include "SubMesh.h"

#include <algorithm>

namespace pm {
namespace {

/// Place in an ascending list, kNone when it is not there.
Id placeOf(Span<Id> list, Id value) {
  const Id* const it = std::lower_bound(list.begin(), list.end(), value);
  return it != list.end() && *it == value ? static_cast<Id>(it - list.begin()) : kNone;
}
Id placeOf(const std::vector<Id>& list, Id value) { return placeOf(spanOf(list), value); }

/// The cells' faces: internal ones of the part, then the boundary's, then those it is cut out along.
std::vector<Id> sortedFaces(const PolyMesh& mesh, const Csr<Id>& facesOfCell, const std::vector<Id>& cells) {
  std::vector<Id> faces;
  for (Id c : cells) faces.insert(faces.end(), facesOfCell[c].begin(), facesOfCell[c].end());
  sortUnique(faces);
  const auto kind = [&](Id f) {
    if (f >= mesh.internalFaces()) return 1;
    return placeOf(cells, mesh.owner[f]) != kNone && placeOf(cells, mesh.neighbour[f]) != kNone ? 0 : 2;
  };
  std::stable_sort(faces.begin(), faces.end(), [&](Id f, Id g) { return kind(f) < kind(g); });
  return faces;
}

}  // namespace

Id SubMesh::pointOf(Id whole) const { return placeOf(points, whole); }

// Faces of a kind follow each other, ascending; those along the cut come last.
Id SubMesh::boundaryFaceOf(Id whole) const {
  const Id cut = static_cast<Id>(mesh.patchNames.size()) - 1, internal = mesh.internalFaces();
  const auto end = std::find(mesh.patch.begin(), mesh.patch.end(), cut);
  const Id* const first = faces.data() + internal;
  const Id place = placeOf(Span<Id>{first, first + (end - mesh.patch.begin())}, whole);
  return place == kNone ? kNone : internal + place;
}

SubMesh subMesh(const PolyMesh& mesh, const Csr<Id>& facesOfCell, std::vector<Id> cells) {
  SubMesh part;
  part.cells = std::move(cells);
  part.faces = sortedFaces(mesh, facesOfCell, part.cells);
  for (Id f : part.faces) part.points.insert(part.points.end(), mesh.faces[f].begin(), mesh.faces[f].end());
  sortUnique(part.points);
  PolyMesh& m = part.mesh;
  for (Id p : part.points) {
    m.points.push_back(mesh.points[p]);
    m.base.push_back(part.pointOf(mesh.base[p]));
    m.fixed.push_back(mesh.fixed.empty() ? 0 : mesh.fixed[p]);
  }
  for (Id c : part.cells) {
    m.level.push_back(mesh.level[c]);
    m.layer.push_back(mesh.layer[c]);
  }
  m.cellCount = static_cast<Id>(part.cells.size());
  m.patchNames = mesh.patchNames;
  m.patchTypes = mesh.patchTypes;
  m.patchNames.push_back("cut");
  m.patchTypes.push_back("patch");
  m.finestSize = mesh.finestSize;
  m.stage = mesh.stage;
  std::vector<Id> row;
  for (Id f : part.faces) {
    row.clear();
    for (Id p : mesh.faces[f]) row.push_back(part.pointOf(p));
    const bool internal = f < mesh.internalFaces();
    const Id own = placeOf(part.cells, mesh.owner[f]);
    const Id other = internal ? placeOf(part.cells, mesh.neighbour[f]) : kNone;
    if (own == kNone) std::reverse(row.begin(), row.end());  // leaves the cell that is in the part
    m.faces.push(row);
    m.owner.push_back(own != kNone ? own : other);
    if (own != kNone && other != kNone) {
      m.neighbour.push_back(other);
    } else {
      m.patch.push_back(internal ? static_cast<Id>(m.patchNames.size()) - 1
                                 : mesh.patch[f - mesh.internalFaces()]);
    }
  }
  return part;
}

}  // namespace pm
