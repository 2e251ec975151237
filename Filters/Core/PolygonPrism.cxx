// SPDX-License-Identifier: BSD-3-Clause
#include "PolygonPrism.h"

#include <algorithm>

namespace pm {

std::size_t PolygonPrism::cornerOf(Id point) const {
  const auto found = std::find(below.begin(), below.end(), point);
  return found != below.end()
             ? static_cast<std::size_t>(found - below.begin())
             : static_cast<std::size_t>(std::find(above.begin(), above.end(), point) - above.begin());
}

bool findPrism(const PolyMesh& mesh, Span<Id> facesOfCell, Id cell, PolygonPrism& prism) {
  prism = PolygonPrism();
  for (Id f : facesOfCell) {
    if (mesh.faces[f].size() == 4) continue;
    if (prism.lid != kNone) return false;
    (prism.base == kNone ? prism.base : prism.lid) = f;
  }
  if (prism.lid == kNone) return false;
  const Span<Id> base = mesh.faces[prism.base], lid = mesh.faces[prism.lid];
  const std::size_t n = base.size();
  if (n < 5 || lid.size() != n || facesOfCell.size() != n + 2) return false;
  prism.below.assign(base.begin(), base.end());
  if (mesh.owner[prism.base] != cell) std::reverse(prism.below.begin(), prism.below.end());
  prism.above.assign(n, kNone);
  for (Id f : facesOfCell) {
    if (f == prism.base || f == prism.lid) continue;
    const Span<Id> row = mesh.faces[f];
    for (std::size_t k = 0; k < 4; ++k) {  // the edge in the base, and what lies over its ends
      const Id p = row[k], q = row[(k + 1) % 4];
      const std::size_t i = prism.cornerOf(p), j = prism.cornerOf(q);
      if (i >= n || j >= n || prism.below[i] != p || prism.below[j] != q) continue;
      for (const auto& [corner, over] : {std::pair{i, row[(k + 3) % 4]}, std::pair{j, row[(k + 2) % 4]}}) {
        if (prism.above[corner] != kNone && prism.above[corner] != over) return false;
        prism.above[corner] = over;
      }
    }
  }
  std::vector<Id> wanted(lid.begin(), lid.end()), found = prism.above;
  std::sort(wanted.begin(), wanted.end());
  std::sort(found.begin(), found.end());
  return wanted == found;
}

}  // namespace pm
