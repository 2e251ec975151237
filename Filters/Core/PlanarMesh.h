// SPDX-License-Identifier: BSD-3-Clause
// A mesh for two-dimensional flow: the section of a finished mesh by a plane square to an axis, one cell
// thick (thesis 5.5: a geometry thickened from a cross-section is meshed, and a section of the mesh is the 2D
// mesh).
//
// Each edge that the plane cuts gives a node, each face a side, each cell a polygon, so the section of a
// conformal mesh is conformal. Where the plane passes a point of the mesh closer than a quarter of an edge,
// all nodes around that point are drawn into one, on the plane: else there would be slivers. The polygons are
// then moved along the axis by half the thickness to either side.
//
// Passes: sides of points; nodes drawn together; sides and polygons of the section; undo what folds a polygon
// or pinches the section, and again; cut polygons that are hollow; the mesh one cell thick.
#pragma once

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

struct PlanarMeshOptions {
  int axis = 2;          ///< the plane is square to x (0), y (1) or z (2)
  double position = 0;   ///< of the plane on that axis
  double thickness = 0;  ///< of the mesh; 0 = that of the smallest octree cell
};

struct PlanarMeshReport {
  Id cells = 0;
  double area = 0;       ///< of the section
  Id drawnTogether = 0;  ///< points of the input whose nodes are one
};

/// mesh: of any stage from PaintFront on. The result is Refined, in the slab position +- thickness / 2: its
/// faces there are the patches "front" (above) and "back", of type "empty"; its other boundary faces are in
/// the patches of the faces that were cut. A cell has the level, layer and zone of the cell it was cut from.
/// Same bits for any number of threads; linear time, but for sorting the section.
///
/// Throws InputError when the plane does not meet the mesh, or its section touches itself.
PolyMesh planarMesh(const PolyMesh& mesh, const PlanarMeshOptions& options, Monitor& monitor,
                    PlanarMeshReport* report = nullptr);

}  // namespace pm
