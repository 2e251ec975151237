// SPDX-License-Identifier: BSD-3-Clause
#include "CellRecognition.h"

#include "vtkCellType.h"

#include <algorithm>

namespace pm {

const RecognisedCell& CellRecogniser::recognise(const PolyMesh& mesh, Span<Id> faces, Id cell) {
  count_ = faces.size();
  if (rows_.size() < count_) rows_.resize(count_);
  std::size_t triangles = 0, quads = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Span<Id> row = mesh.faces[faces[i]];
    if (mesh.owner[faces[i]] == cell) {
      rows_[i].assign(row.begin(), row.end());
    } else {
      rows_[i].assign(std::make_reverse_iterator(row.end()), std::make_reverse_iterator(row.begin()));
    }
    triangles += row.size() == 3;
    quads += row.size() == 4;
  }
  found_.points.clear();
  const bool simple = triangles + quads == count_;
  if (simple && quads == 6 && triangles == 0 && prism(4)) {
    found_.vtkType = VTK_HEXAHEDRON;
  } else if (simple && quads == 3 && triangles == 2 && prism(3)) {
    found_.vtkType = VTK_WEDGE;
  } else if (simple && quads == 0 && triangles == 4 && pyramid(3)) {
    found_.vtkType = VTK_TETRA;
  } else if (simple && quads == 1 && triangles == 4 && pyramid(4)) {
    found_.vtkType = VTK_PYRAMID;
  } else {
    polyhedron();
  }
  return found_;
}

std::size_t CellRecogniser::firstFaceOf(std::size_t corners) const {
  std::size_t face = 0;
  while (rows_[face].size() != corners) ++face;
  return face;
}

/// The point after the directed edge from -> to in a face, null when the face has no such edge.
const Id* CellRecogniser::after(std::size_t face, Id from, Id to) const {
  const std::vector<Id>& row = rows_[face];
  const std::size_t n = row.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (row[i] == from && row[(i + 1) % n] == to) return &row[(i + 2) % n];
  }
  return nullptr;
}

/// A base of 3 or 4 corners, a quad on each of its edges, a lid. Base corners b run outward, lid corners t
/// lie on them.
bool CellRecogniser::prism(std::size_t corners) {
  const std::size_t base = firstFaceOf(corners);
  const std::vector<Id>& b = rows_[base];
  Id lid[4] = {kNone, kNone, kNone, kNone};
  std::size_t lidFace = count_;
  for (std::size_t face = 0; face < count_; ++face) {
    if (face == base) continue;
    bool side = false;
    for (std::size_t i = 0; i < corners; ++i) {
      const std::size_t j = (i + 1) % corners;
      // An outward side runs b[j], b[i], t[i], t[j].
      const Id* top = rows_[face].size() == 4 ? after(face, b[j], b[i]) : nullptr;
      if (!top) continue;
      const Id topJ = *after(face, b[i], *top);
      if ((lid[i] != kNone && lid[i] != *top) || (lid[j] != kNone && lid[j] != topJ)) return false;
      lid[i] = *top;
      lid[j] = topJ;
      side = true;
    }
    if (side) continue;
    if (lidFace != count_ || rows_[face].size() != corners) return false;
    lidFace = face;
  }
  if (lidFace == count_) return false;
  for (std::size_t i = 0; i < corners; ++i) {
    if (lid[i] == kNone || !after(lidFace, lid[(i + 1) % corners], lid[i])) return false;
    if (std::find(b.begin(), b.end(), lid[i]) != b.end()) return false;
  }
  if (corners == 3) {
    found_.points = {b[0], b[1], b[2], lid[0], lid[1], lid[2]};
  } else {  // a hexahedron's base runs inward
    found_.points = {b[0], b[3], b[2], b[1], lid[0], lid[3], lid[2], lid[1]};
  }
  return true;
}

/// A base of 3 or 4 corners and triangles that share an apex.
bool CellRecogniser::pyramid(std::size_t corners) {
  const std::size_t base = firstFaceOf(corners);
  const std::vector<Id>& b = rows_[base];
  Id apex = kNone;
  for (std::size_t i = 0; i < corners; ++i) {
    const Id* top = nullptr;
    for (std::size_t face = 0; face < count_ && !top; ++face) {
      if (face != base) top = after(face, b[(i + 1) % corners], b[i]);
    }
    if (!top || (apex != kNone && *top != apex)) return false;
    apex = *top;
  }
  if (std::find(b.begin(), b.end(), apex) != b.end()) return false;
  found_.points.push_back(b[0]);
  for (std::size_t i = corners - 1; i > 0; --i) found_.points.push_back(b[i]);
  found_.points.push_back(apex);
  return true;
}

void CellRecogniser::polyhedron() {
  found_.vtkType = VTK_POLYHEDRON;
  found_.points.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    found_.points.insert(found_.points.end(), rows_[i].begin(), rows_[i].end());
  }
  std::sort(found_.points.begin(), found_.points.end());
  found_.points.erase(std::unique(found_.points.begin(), found_.points.end()), found_.points.end());
}

}  // namespace pm
