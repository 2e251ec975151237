// SPDX-License-Identifier: BSD-3-Clause
// A quality report as cell arrays, faces and tables.
#pragma once

#include "MeshQualityReport.h"

class vtkPolyData;
class vtkTable;
class vtkUnstructuredGrid;

namespace pm {

/// A cell array for each measure; of faces, the worst of the cell's.
void addQuality(const MeshQualityReport& report, const PolyMesh& mesh, vtkUnstructuredGrid* grid);

/// The faces outside a limit with all their measures (NaN where one is not defined), Face, Owner, Neighbour
/// (-1 on the boundary), PatchId (-1 inside) and Broken, how many limits they break; field PatchNames.
void packFacesOutside(const MeshQualityReport& report, const PolyMesh& mesh, vtkPolyData* surface);

/// Columns Measure, Value, Limit, Outside (1 when the value is), Face, Cell, Neighbour, Patch, Position.
void packWorstPlaces(const MeshQualityReport& report, const PolyMesh& mesh, vtkTable* table);

/// Columns Measure, From, To, Count: a row for each bin.
void packHistograms(const MeshQualityReport& report, vtkTable* table);

/// Columns Measure, Of (cells or faces), Minimum, Maximum, Mean, Limit, Outside; a row for each measure.
void packQualitySummary(const MeshQualityReport& report, vtkTable* table);

}  // namespace pm
