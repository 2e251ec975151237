// SPDX-License-Identifier: BSD-3-Clause
// A mesh as a Fluent mesh file (.msh): nodes, cells, faces, and the names and types of their zones.
//
// Source: the appendix on file formats of the Fluent User's Guide. Sections that are written, in this order:
//
//   index             what
//   0, 1, 2           comment, header, dimension
//   4                 byte order, binary only
//   10 / 3010         nodes, one zone
//   12 / 3012         cells, a zone for each of the mesh's zones (one, "fluid", when it has none); its cells
//                     are consecutive, else in the mesh's order; element types listed when they differ
//   13 / 3013         faces, zones as described at writeFluent; element type 3 or 4 when all faces of the
//                     zone are triangles or quads, 0 when they are either, 5 (polygons) when some are neither
//   45                name and type of each zone of cells and faces
//
// Ids count from 1. The right-hand normal of a face's points enters its first cell, c0, which is the mesh's
// owner; c1 is the neighbour, or 0. Fluent's hanging nodes are not used: a cell that has more faces than its
// shape, or faces with more corners, is a polyhedron.
#pragma once

#include <string>

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

/// Fluent's element types.
enum class FluentCell : std::uint8_t {
  Tetrahedron = 2,
  Hexahedron = 4,
  Pyramid = 5,
  Wedge = 6,
  Polyhedron = 7
};

/// Shape of the cell with these faces. A cell is one of the plain shapes when it has its triangles and quads
/// and three of them meet at each corner (at a pyramid's apex, four): no other closed cell has.
FluentCell fluentCell(const PolyMesh& mesh, Span<Id> faces);

/// A boundary condition of Fluent: the number in a section of faces and the word in that of the zone.
struct FluentBoundary {
  int type;
  const char* word;
};

/// What patch `patchId` becomes: a wall where foamPatchType says wall. Of the others a name with inlet or
/// inflow makes a velocity-inlet, one with farfield, or "far" (the far sphere), a pressure-far-field; the
/// rest, domain sides too, are pressure-outlets, which flow may pass either way.
FluentBoundary fluentBoundary(const PolyMesh& mesh, Id patchId);

/// Writes the mesh. Zones of faces: the interior of each zone of cells, then each patch. Fluent wants one
/// zone of cells behind a zone of faces: a patch that several zones of cells touch is written as one zone for
/// each, with their names behind its own. Names are those of foamPatchNames. Coordinates keep every bit, in
/// ascii too. The file is written beside its place and then put there: what stood there stays when writing
/// fails. Throws InputError when the file cannot be written or the disk is full, AbortError on request.
void writeFluent(const PolyMesh& mesh, const std::string& path, bool binary, Monitor& monitor);

}  // namespace pm
