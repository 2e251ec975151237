// SPDX-License-Identifier: BSD-3-Clause
// A surface of polygons as an ascii STL file with a solid for each patch.
#pragma once

#include <string>
#include <vector>

#include "Monitor.h"
#include "Types.h"

namespace pm {

struct PolygonSurface {
  std::vector<Vec3> points;  // #P by 3
  Csr<Id> polygons;          // #F rows of three or more points
  std::vector<Id> patch;     // #F index into patchNames
  std::vector<std::string> patchNames;
};

/// Writes the polygons as triangles: a flat quad as two, larger and warped ones around the mean of their
/// corners. So the triangles join without gaps where the polygons do, and enclose the very volume that the
/// suite's measures give the mesh behind them. Solids are in the order of the patches; a patch without
/// polygons is left out. Control characters of a name become blanks. Coordinates keep every bit; normals are
/// for information. The file is written beside its place and then put there: what stood there stays when
/// writing fails. Throws InputError when there are no polygons, the file cannot be written or the disk is
/// full, AbortError on request. Linear in the polygons, formatted in parallel.
void writeStl(const PolygonSurface& surface, const std::string& path, Monitor& monitor);

}  // namespace pm
