// SPDX-License-Identifier: BSD-3-Clause
#include "RegionPacking.h"

#include "GridArrays.h"
#include "PaintFront.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTypeInt32Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

std::vector<Id> cellCounts(const PaintFrontReport& report) {
  return column<Id>(report.regions, [](const PaintedRegion& r) { return r.cells; });
}
std::vector<double> volumes(const PaintFrontReport& report) {
  return column<double>(report.regions, [](const PaintedRegion& r) { return r.volume; });
}
std::vector<std::uint8_t> openFlags(const PaintFrontReport& report) {
  return column<std::uint8_t>(report.regions, [](const PaintedRegion& r) { return std::uint8_t(r.open); });
}

/// Rows of several numbers each.
void addRows(vtkFieldData* data, const char* name, int components, const std::vector<double>& values) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  data->AddArray(array);
}

/// Names of the zones beside the regions that are in the mesh.
std::vector<std::string> zoneNames(const PaintFrontReport& report, const PolyMesh& mesh) {
  std::size_t zone = 0;
  return column<std::string>(report.regions, [&](const PaintedRegion& r) {
    return r.chosen && zone < mesh.zoneNames.size() ? mesh.zoneNames[zone++] : std::string();
  });
}

std::string joinNames(const std::vector<Id>& patches, const PolyMesh& mesh) {
  std::string names;
  for (Id patch : patches) names += (names.empty() ? "" : ", ") + mesh.patchNames[patch];
  return names;
}

void append(std::vector<double>& values, const Box& box) {
  for (int a = 0; a < 3; ++a) values.insert(values.end(), {box.lo[a], box.hi[a]});
}

/// The values of one kind of all places.
template <class T, class Value>
std::vector<T> perPlace(const NarrowPassages& invisible, const Value& value) {
  std::vector<T> values;
  for (const NarrowPlace& place : invisible.places) values.push_back(value(place));
  return values;
}

void packPlaces(const NarrowPassages& invisible, const PolyMesh& mesh, vtkFieldData* field) {
  std::vector<double> centres, bounds;
  for (const NarrowPlace& place : invisible.places) {
    centres.insert(centres.end(), place.centre.data(), place.centre.data() + 3);
    append(bounds, place.bounds);
  }
  addArray<vtkTypeInt32Array>(field, "PlaceCells",
                              perPlace<Id>(invisible, [](const auto& p) { return p.cells; }));
  addRows(field, "PlaceCentre", 3, centres);
  addRows(field, "PlaceBounds", 6, bounds);
  addArray<vtkDoubleArray>(field, "PlaceNarrowest",
                           perPlace<double>(invisible, [](const auto& p) { return p.narrowest; }));
  addArray<vtkDoubleArray>(field, "PlaceMedian",
                           perPlace<double>(invisible, [](const auto& p) { return p.median; }));
  addArray<vtkDoubleArray>(field, "PlaceFeatureSize",
                           perPlace<double>(invisible, [](const auto& p) { return p.featureSize; }));
  addStrings(field, "PlacePatches",
             perPlace<std::string>(invisible, [&](const auto& p) { return joinNames(p.patches, mesh); }));
  addArray<vtkTypeInt32Array>(field, "PlaceLeadsTo",
                              perPlace<Id>(invisible, [](const auto& p) { return p.leadsTo; }));
}

}  // namespace

void packRegions(const PaintFrontReport& report, vtkUnstructuredGrid* grid) {
  addArray<vtkTypeInt32Array>(grid->GetFieldData(), "RegionCells", cellCounts(report));
  addArray<vtkDoubleArray>(grid->GetFieldData(), "RegionVolume", volumes(report));
  addArray<vtkUnsignedCharArray>(grid->GetFieldData(), "RegionOpen", openFlags(report));
  if (grid->GetNumberOfCells() == static_cast<vtkIdType>(report.regionOfCell.size()))
    addArray<vtkTypeInt32Array>(grid->GetCellData(), "Region", report.regionOfCell);
  if (!report.notes.empty()) addStrings(grid->GetFieldData(), "Notes", report.notes);
}

void packRegionTable(const PaintFrontReport& report, const PolyMesh& mesh, vtkTable* table) {
  table->Initialize();
  vtkDataSetAttributes* rows = table->GetRowData();
  Id next = 0;
  std::vector<double> points, bounds;
  for (const PaintedRegion& region : report.regions) {
    points.insert(points.end(), region.point.data(), region.point.data() + 3);
    append(bounds, region.bounds);
  }
  addArray<vtkTypeInt32Array>(rows, "Region",
                              column<Id>(report.regions, [&](const PaintedRegion&) { return next++; }));
  addArray<vtkDoubleArray>(rows, "Volume", volumes(report));
  addArray<vtkTypeInt32Array>(rows, "Cells", cellCounts(report));
  addArray<vtkUnsignedCharArray>(rows, "Open", openFlags(report));
  addArray<vtkUnsignedCharArray>(
      rows, "Chosen",
      column<std::uint8_t>(report.regions, [](const PaintedRegion& r) { return std::uint8_t(r.chosen); }));
  addStrings(rows, "Zone", zoneNames(report, mesh));
  addStrings(rows, "Patches", column<std::string>(report.regions, [&](const PaintedRegion& r) {
               return joinNames(r.patches, mesh);
             }));
  addRows(rows, "Point", 3, points);
  addRows(rows, "Bounds", 6, bounds);
}

void packInvisible(const PaintFrontReport& report, const PolyMesh& mesh, vtkPolyData* points) {
  points->Initialize();
  const NarrowPassages& invisible = report.invisible;
  vtkNew<vtkPoints> coordinates;
  coordinates->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  std::vector<Id> place;
  std::vector<double> width, size;
  for (const NarrowCell& cell : invisible.cells) {
    const vtkIdType id = coordinates->InsertNextPoint(cell.point.data());
    vertices->InsertNextCell(1, &id);
    place.push_back(cell.place);
    width.push_back(cell.width);
    size.push_back(cell.featureSize);
  }
  points->SetPoints(coordinates);
  points->SetVerts(vertices);
  addArray<vtkTypeInt32Array>(points->GetPointData(), "Place", place);
  addArray<vtkDoubleArray>(points->GetPointData(), "Width", width);
  addArray<vtkDoubleArray>(points->GetPointData(), "FeatureSize", size);
  if (!invisible.places.empty()) packPlaces(invisible, mesh, points->GetFieldData());
}

}  // namespace pm
