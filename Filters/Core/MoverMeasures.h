// SPDX-License-Identifier: BSD-3-Clause
// The measures that NodeMover takes again and again: those of MeshQuality and FoamQuality by the same
// formulas, arranged so that nothing is computed twice and the corners of a quad go through together.
#pragma once

#include "MeshQuality.h"

namespace pm {

/// A face as one of its cells sees it.
struct CellFace {
  Span<Id> row;
  const Vec3 *centre, *normal;
  double sign;  ///< 1 when the normal leaves the cell, else -1
};

/// measureCell() with what is known of the faces: one cross product for each central triangle.
CellMeasures measureCell(const std::vector<Vec3>& points, Span<Id> pointsOfCell, Span<CellFace> faces);

/// What lies between a face and its cells.
struct FaceRelation {
  double cosAngle = 1;  ///< the worse of the thesis' and of OpenFOAM's cell centres
  double skew = 0, weight = 0.5, volumeRatio = 1;
  double tet = 0;  ///< faceTetVolume()
};
/// next: null on the boundary; enough: see faceTetVolume().
FaceRelation relate(const std::vector<Vec3>& points, Span<Id> row, const Vec3& centre, const Vec3& normal,
                    const CellMeasures& own, const CellMeasures* next, double enough);

}  // namespace pm
