// SPDX-License-Identifier: BSD-3-Clause
// Prisms over polygons of five and more corners, as layers have them below such wall faces: cut into wedges
// they need no new point.
#pragma once

#include <array>

#include "PolyMesh.h"

namespace pm {

struct PolygonPrism {
  Id base = kNone, lid = kNone;  ///< faces; the base is the one of the smaller id
  std::vector<Id> below, above;  ///< corners of the base, seen from outside; the lid's point over each

  std::size_t size() const { return below.size(); }
  std::size_t next(std::size_t corner, std::size_t by) const { return (corner + by) % below.size(); }
  /// Which corner is this point of the base, or has this point of the lid over it.
  std::size_t cornerOf(Id point) const;
};

/// Whether a cell is such a prism: two polygons of as many corners, and a quad on each edge between them.
bool findPrism(const PolyMesh& mesh, Span<Id> facesOfCell, Id cell, PolygonPrism& prism);

/// Calls body(corners below, corners above), three each and turning as the base, for the wedges over the
/// base's fan from a corner.
template <class Body>
void forEachWedge(const PolygonPrism& prism, std::size_t corner, const Body& body) {
  for (std::size_t i = 1; i + 1 < prism.size(); ++i) {
    const std::size_t a = corner, b = prism.next(corner, i), c = prism.next(corner, i + 1);
    body(std::array<Id, 3>{prism.below[a], prism.below[b], prism.below[c]},
         std::array<Id, 3>{prism.above[a], prism.above[b], prism.above[c]});
  }
}

}  // namespace pm
