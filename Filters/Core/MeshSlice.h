// SPDX-License-Identifier: BSD-3-Clause
// A plane through polyhedral cells: one polygon a cell, without holes wherever the plane lies.
//
// A point is below the plane or above it; a point in the plane counts as above. An edge with an end on either
// side is crossed once, at a place that its two ends alone decide. On each face the crossings are linked in
// pairs, by a rule in which the cell has no part; each crossed edge of a cell has two faces, so the links of
// a cell close to loops. Cells that share a face share the link on it, and their polygons a whole side:
// nothing is left out between them and nothing is covered twice, for planes through points, edges and faces
// as well.
//
// A face in the plane belongs to the cell below it. Where there is none, on the mesh's boundary, the cell
// above it has the polygon: a section in a plane of symmetry is complete whichever way its normal points.
//
// Faces may be warped and need not be convex: of a face that the plane crosses four times or more, its centre
// says which of the two parts hangs together. Where a face reaches up to the plane and no farther, its link
// runs through its points there. The way a face runs (seen from inside or outside) does not matter. A cell
// whose faces are not closed gives the polygon of what there is. Links are straight: at the corner of a cell
// so warped that two of them cross, its polygon lies on a neighbour's.
//
// Work is linear in the cells that are given but for sorting the crossings; in parallel, with the same bits
// for any number of threads.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "Monitor.h"

namespace pm {

/// Where a point of a section lies: at part in [0, 1) of the way from one point of the mesh to another.
/// low == high, part == 0: a point of the mesh.
struct EdgeCrossing {
  Id low = 0, high = 0;
  double part = 0;
};

struct PlaneSection {
  std::vector<EdgeCrossing> points;  ///< by low, then high; each once
  Csr<Id> polygons;                  ///< rows of points, counter-clockwise seen from above
  std::vector<Id> cell;              ///< that a polygon is of: an index into the cells given
};

/// A plane for the section: points before it (along its normal) have positive distances.
struct SlicePlane {
  Vec3 origin = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< length 1

  /// Length, 0 where it is no more than the tolerance.
  double distance(const Vec3& p, double tolerance) const {
    const double d = normal.dot(p - origin);
    return std::abs(d) <= tolerance ? 0.0 : d;
  }
};

/// The section of cells (rows of faces) with faces (rows of points). distance: of every point they name, by
/// SlicePlane::distance; position: coordinates of a point, called from several threads. Cells that the plane
/// does not touch may be given, and cost the reading of their distances.
PlaneSection sliceCells(const Csr<Id>& faces, const Csr<Id>& cells, const std::vector<double>& distance,
                        const std::function<Vec3(Id)>& position, const SlicePlane& plane, Monitor& monitor);

}  // namespace pm
