// SPDX-License-Identifier: BSD-3-Clause
// What painting found, as VTK data: beside the mesh, as a table, and as points.
#pragma once

class vtkPolyData;
class vtkTable;
class vtkUnstructuredGrid;

namespace pm {

struct PaintFrontReport;
struct PolyMesh;

/// Field arrays RegionCells int32, RegionVolume double, RegionOpen uint8 of the grid, one value a region,
/// largest first. A grid whose cells are those of the front also has the cell array Region int32: where its
/// cells lie. Field array Notes string: sentences on what became invisible; absent when there are none.
void packRegions(const PaintFrontReport& report, vtkUnstructuredGrid* grid);

/// One row a region, largest first. Columns: Region (its id), Volume, Cells, Open (1 = reaches the sides of
/// the octree), Chosen (1 = in the mesh), Zone (its name in the mesh, "" = none), Patches (names of the
/// patches it touches), Point (3, inside it), Bounds (6: xmin, xmax, ymin, ymax, zmin, zmax).
void packRegionTable(const PaintFrontReport& report, const PolyMesh& mesh, vtkTable* table);

/// A vertex for each leaf of the domain that is too narrow for a cell. Point arrays Place int32 (0 = most
/// cells) and Width, FeatureSize double, of the leaf. Field arrays, one value a place: PlaceCells int32,
/// PlaceCentre (3), PlaceBounds (6), PlaceNarrowest, PlaceMedian, PlaceFeatureSize double, PlacePatches
/// string, PlaceLeadsTo int32 (region not in the mesh, -1 = none). Units: lengths.
void packInvisible(const PaintFrontReport& report, const PolyMesh& mesh, vtkPolyData* points);

}  // namespace pm
