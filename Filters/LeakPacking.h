// SPDX-License-Identifier: BSD-3-Clause
// Leaks and holes as data that ParaView shows.
#pragma once

#include <vector>

#include "CloseHoles.h"

class vtkPolyData;
class vtkTable;

namespace pm {

/// A vertex at each bottleneck, then a polyline for each leak, widest first. Cell arrays Leak (0 = widest)
/// int32, NarrowestWidth and SealingSize double; point array Width double: twice the distance to the
/// geometry. Units: lengths.
void packLeaks(const std::vector<Leak>& leaks, vtkPolyData* paths);

/// The membranes. Cell arrays Leak int32, NarrowestWidth double, Closed uint8.
void packMembranes(const std::vector<Hole>& holes, vtkPolyData* surface);

/// One row a hole, widest first. Columns: Leak, Width, SealingSize, Area, Place (3), Closed (1 = closed now),
/// Wide (1 = an opening about as wide as its room, which may be meant).
void packHoleTable(const std::vector<Hole>& holes, vtkTable* table);

/// Triangles with the cell array PatchId and the field array PatchNames, as surfaceFrom() reads them.
void packSurface(const SurfaceModel& model, vtkPolyData* surface);

}  // namespace pm
