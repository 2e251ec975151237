// SPDX-License-Identifier: BSD-3-Clause
// PolyMesh <-> vtkUnstructuredGrid: what flows between the filters, in memory and through .vtu files.
//
// A packed grid holds the mesh's points and cells in their order; a cell is a hexahedron, wedge, tetrahedron
// or pyramid where its faces are exactly those of one, else a VTK_POLYHEDRON. Everything else a later stage
// needs is in arrays of the grid (#C cells, #P points, #B boundary faces in canonical order):
//
//   cell   Level          uint8  #C      octree level
//   cell   Layer          uint8  #C      0 = not a layer cell, 1 = at the wall, 2 = next to it, ...
//   cell   Zone           int32  #C      zone of the cell; absent when the mesh is one zone
//   point  Fixed          uint8  #P      bit a set: coordinate a may not move
//   point  Base           int32  #P      lower end of a wall point's prism edge, -1 = none
//   field  BoundaryPatch  int32  #B      patch of each boundary face
//   field  PatchNames     string         name of each patch
//   field  PatchTypes     string         "wall", "patch" or "empty", beside PatchNames
//   field  ZoneNames      string         name of each zone; absent when the mesh is one zone
//   field  FinestSize     double 1       edge of the smallest octree cell
//   field  ProjectionMesherStamp int64 6 format, stage, #P, #C, #B, pm::checksum
//
// Faces are not stored: they follow from the cells, and canonicalise() gives them the one order that follows
// from the cells alone. So unpackMesh(packMesh(mesh)) equals a canonical mesh bit for bit; the stamp
// recognises a grid that something else has changed. All work is linear in the cells and parallel.
#pragma once

#include <initializer_list>

#include "PolyMesh.h"

class vtkPolyData;
class vtkUnstructuredGrid;

namespace pm {

/// The volume grid. The mesh must be canonical.
void packMesh(const PolyMesh& mesh, vtkUnstructuredGrid* grid);

/// The boundary faces with the points they use; cell array PatchId, field arrays PatchNames and PatchTypes.
void packBoundary(const PolyMesh& mesh, vtkPolyData* surface);

/// The mesh back from its grid. filter: the asking filter's name, for messages. Throws InputError when the
/// grid is of another stage than those accepted (empty = any mesh), was not made by packMesh, or was changed
/// since.
PolyMesh unpackMesh(vtkUnstructuredGrid* grid, const std::string& filter,
                    std::initializer_list<Stage> accepted);

/// Whether the grid carries the stamp of packMesh.
bool isPacked(vtkUnstructuredGrid* grid);

/// Points and cells of any grid of tetrahedra, pyramids, wedges, hexahedra, voxels and polyhedra, to be
/// looked at: one patch "boundary", no arrays, no finest size, Stage::None. Throws InputError for other cells
/// and when cells overlap.
PolyMesh unpackCells(vtkUnstructuredGrid* grid, const std::string& filter);

}  // namespace pm
