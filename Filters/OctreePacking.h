// SPDX-License-Identifier: BSD-3-Clause
// Octree <-> vtkUnstructuredGrid: one VTK_VOXEL for each leaf, corner points shared.
//
//   cell   Level   uint8  #L   level of the leaf
//   cell   Cut     uint8  #L   1 = a triangle touches the leaf
//   cell   Key     int64  #L   Morton code of the lower corner on the finest grid, ascending
//   cell   RefinedBy  uint8  #L  criterion that split the leaf's parent, a RefineReason
//   cell   RefinedByPatch  int16  #L  patch of the triangle that asked, -1 = none
//   field  RefinedByNames  string  what the values of RefinedBy mean
//   field  BrickOrigin double 3, BrickRootSize double 3, BrickRoots int32 3, BrickMaxLevel int32 1,
//          BrickSidesArePatches int32 1
//   field  ProjectionMesherStamp int64 6   as in MeshPacking.h, #B = 0
//
// Lists of triangles and reasons are not kept: an unpacked octree has none, but its cut flags.
#pragma once

#include "Octree.h"

class vtkUnstructuredGrid;

namespace pm {

void packOctree(const Octree& tree, vtkUnstructuredGrid* grid);

/// filter: the asking filter's name, for messages. Throws InputError when the grid is none of packOctree's,
/// or was changed since.
Octree unpackOctree(vtkUnstructuredGrid* grid, const std::string& filter);

}  // namespace pm
