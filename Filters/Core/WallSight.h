// SPDX-License-Identifier: BSD-3-Clause
// Which way to leave the wall: at each wall point the direction that sees all wall faces around it.
//
// A thin cell on a wall face is valid only where the prism edges at its corners rise from the face. How well
// a direction does so at a point is its smallest cosine to the inward normals of the wall faces there: 1 on a
// flat wall, 0.7 on the edge of a cube, 0 at the end of a thin sheet, below 0 where the wall folds back.
#pragma once

#include "PolyMesh.h"

namespace pm {

class WallSight {
 public:
  explicit WallSight(const PolyMesh& mesh);

  /// The direction with the largest smallest cosine, of unit length; it keeps to domain sides. Wall points
  /// only.
  const Vec3& best(Id wallPoint) const { return best_[wallPoint]; }
  double bestCosine(Id wallPoint) const { return bestCosine_[wallPoint]; }
  /// Smallest cosine of a direction of any length but zero.
  double cosine(Id wallPoint, const Vec3& direction) const;

 private:
  void findBest(const PolyMesh& mesh, Id point);

  Csr<Vec3> normals_;  // #P inward unit normals of the wall faces around it
  std::vector<Vec3> best_;
  std::vector<double> bestCosine_;
};

}  // namespace pm
