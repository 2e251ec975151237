// SPDX-License-Identifier: BSD-3-Clause
// One order of a mesh's points for fans: the fan of each face begins at its first point, that of each cell at
// its first point, and both then fit.
//
// Points that hang on a neighbour come first: those in the middle of a cell's flat side, then those in the
// middle of a straight edge, since a fan from a corner would have flat triangles and cells at them. Corners
// follow by x + y + z, which cuts cubes into six equal tetrahedra (Kuhn's) that fit those next to them.
#pragma once

#include <algorithm>

#include "PolyMesh.h"

namespace pm {

class PointOrder {
 public:
  explicit PointOrder(const PolyMesh& mesh);

  bool before(Id a, Id b) const {
    if (hanging_[a] != hanging_[b]) return hanging_[a] > hanging_[b];
    return along_[a] != along_[b] ? along_[a] < along_[b] : a < b;
  }
  /// Where the first of some points stands among them.
  const Id* firstOf(Span<Id> points) const {
    return std::min_element(points.begin(), points.end(), [this](Id a, Id b) { return before(a, b); });
  }

 private:
  std::vector<std::uint8_t>
      hanging_;                // #P 2: in the middle of a cell's side, 1: of a cell's edge, 0: neither
  std::vector<double> along_;  // #P x + y + z from the mesh's corner
};

}  // namespace pm
