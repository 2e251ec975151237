// SPDX-License-Identifier: BSD-3-Clause
// Triangles and patches for the kernel from what a pipeline delivers.
#pragma once

#include <memory>

#include "SurfaceModel.h"

class vtkDataObject;

namespace pm {

/// data: vtkPolyData, or a composite whose vtkPolyData leaves count and whose other leaves are ignored.
/// Polygons and strips are triangulated, lines and vertices ignored.
///
/// A triangle's patch comes from the first of these that applies:
///  - patchArray, when given and not empty: cell array of ids or names (a missing one is an InputError);
///  - the name of the block, in a composite of several blocks;
///  - the cell array PatchId, GroupIds, STLSolidLabeling, MaterialIds or RegionId;
///  - else all triangles are patch "wall".
/// Names of ids come from the field string array <array>Names or, with or without a final "Id(s)" replaced,
/// PatchNames, GroupNames, MaterialNames; an id without a name becomes "patch<id>". Blocks or ids of equal
/// name are one patch; patches without triangles are left out.
///
/// As long as someone holds a model, the same unchanged data, or other data of equal content, gives that
/// model again instead of a new one. Thread-safe.
///
/// Throws InputError when there is nothing to mesh.
std::shared_ptr<const SurfaceModel> surfaceFrom(vtkDataObject* data, const char* patchArray);

}  // namespace pm
