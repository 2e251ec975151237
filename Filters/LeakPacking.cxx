// SPDX-License-Identifier: BSD-3-Clause
#include "LeakPacking.h"

#include "GridArrays.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

namespace pm {
namespace {

vtkSmartPointer<vtkPoints> newPoints() {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  return points;
}

void addTriangles(const std::vector<std::array<Id, 3>>& triangles, vtkIdType first, vtkCellArray* cells) {
  for (const auto& t : triangles) cells->InsertNextCell({first + t[0], first + t[1], first + t[2]});
}

}  // namespace

void packLeaks(const std::vector<Leak>& leaks, vtkPolyData* paths) {
  const vtkSmartPointer<vtkPoints> points = newPoints();
  vtkNew<vtkCellArray> vertices, lines;
  std::vector<double> width, narrowest, sealing;
  std::vector<int> row;
  for (std::size_t i = 0; i < leaks.size(); ++i) {
    const vtkIdType first = points->GetNumberOfPoints();
    lines->InsertNextCell(static_cast<vtkIdType>(leaks[i].path.size()));
    for (const Vec3& p : leaks[i].path) lines->InsertCellPoint(points->InsertNextPoint(p.data()));
    width.insert(width.end(), leaks[i].widths.begin(), leaks[i].widths.end());
    vertices->InsertNextCell({first + leaks[i].bottleneckRow});
  }
  for (int kind = 0; kind < 2; ++kind)  // vertices come first, then lines
    for (std::size_t i = 0; i < leaks.size(); ++i) {
      row.push_back(static_cast<int>(i));
      narrowest.push_back(leaks[i].width);
      sealing.push_back(leaks[i].sealingSize);
    }
  paths->SetPoints(points);
  paths->SetVerts(vertices);
  paths->SetLines(lines);
  addArray<vtkDoubleArray>(paths->GetPointData(), "Width", width);
  addArray<vtkIntArray>(paths->GetCellData(), "Leak", row);
  addArray<vtkDoubleArray>(paths->GetCellData(), "NarrowestWidth", narrowest);
  addArray<vtkDoubleArray>(paths->GetCellData(), "SealingSize", sealing);
}

void packMembranes(const std::vector<Hole>& holes, vtkPolyData* surface) {
  const vtkSmartPointer<vtkPoints> points = newPoints();
  vtkNew<vtkCellArray> cells;
  std::vector<double> width;
  std::vector<int> row;
  std::vector<unsigned char> closed;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const Membrane& m = holes[i].leak.membrane;
    const vtkIdType first = points->GetNumberOfPoints();
    for (const Vec3& p : m.points) points->InsertNextPoint(p.data());
    addTriangles(m.triangles, first, cells);
    row.insert(row.end(), m.triangles.size(), static_cast<int>(i));
    width.insert(width.end(), m.triangles.size(), m.width);
    closed.insert(closed.end(), m.triangles.size(), holes[i].closed ? 1 : 0);
  }
  surface->SetPoints(points);
  surface->SetPolys(cells);
  addArray<vtkIntArray>(surface->GetCellData(), "Leak", row);
  addArray<vtkDoubleArray>(surface->GetCellData(), "NarrowestWidth", width);
  addArray<vtkUnsignedCharArray>(surface->GetCellData(), "Closed", closed);
}

void packHoleTable(const std::vector<Hole>& holes, vtkTable* table) {
  std::vector<int> row, closed, wide;
  std::vector<double> width, sealing, area;
  vtkNew<vtkDoubleArray> place;
  place->SetName("Place");
  place->SetNumberOfComponents(3);
  for (const Hole& hole : holes) {
    row.push_back(static_cast<int>(row.size()));
    width.push_back(hole.leak.width);
    sealing.push_back(hole.leak.sealingSize);
    area.push_back(hole.leak.membrane.area);
    place->InsertNextTuple(hole.leak.bottleneck.data());
    closed.push_back(hole.closed ? 1 : 0);
    wide.push_back(hole.leak.wide ? 1 : 0);
  }
  vtkFieldData* columns = table->GetRowData();
  addArray<vtkIntArray>(columns, "Leak", row);
  addArray<vtkDoubleArray>(columns, "Width", width);
  addArray<vtkDoubleArray>(columns, "SealingSize", sealing);
  addArray<vtkDoubleArray>(columns, "Area", area);
  columns->AddArray(place);
  addArray<vtkIntArray>(columns, "Closed", closed);
  addArray<vtkIntArray>(columns, "Wide", wide);
}

void packSurface(const SurfaceModel& model, vtkPolyData* surface) {
  const vtkSmartPointer<vtkPoints> points = newPoints();
  points->SetNumberOfPoints(static_cast<vtkIdType>(model.points().size()));
  for (std::size_t p = 0; p < model.points().size(); ++p)
    points->SetPoint(static_cast<vtkIdType>(p), model.points()[p].data());
  vtkNew<vtkCellArray> cells;
  addTriangles(model.triangles(), 0, cells);
  std::vector<int> patch;
  for (Id t = 0; t < model.triangleCount(); ++t) patch.push_back(model.patchOf(t));
  surface->SetPoints(points);
  surface->SetPolys(cells);
  addArray<vtkIntArray>(surface->GetCellData(), "PatchId", patch);
  addStrings(surface->GetFieldData(), "PatchNames", model.patchNames());
}

}  // namespace pm
