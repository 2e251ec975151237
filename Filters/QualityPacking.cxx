// SPDX-License-Identifier: BSD-3-Clause
#include "QualityPacking.h"

#include <cmath>

#include "GridArrays.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTypeInt32Array.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

/// The listed faces and the points they use.
void packRows(const PolyMesh& mesh, const std::vector<Id>& faces, vtkPolyData* surface) {
  std::vector<vtkIdType> newId(mesh.points.size(), -1);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  for (Id f : faces) {
    cells->InsertNextCell(static_cast<int>(mesh.faces[f].size()));
    for (Id p : mesh.faces[f]) {
      if (newId[p] < 0) newId[p] = points->InsertNextPoint(mesh.points[p].data());
      cells->InsertCellPoint(newId[p]);
    }
  }
  surface->SetPoints(points);
  surface->SetPolys(cells);
}

/// The measure's value on a face, NaN where it has none.
double valueOn(const QualityMeasure& m, Id face) {
  const Id row = face - m.first;
  return row >= 0 && row < static_cast<Id>(m.values.size()) ? m.values[row] : std::nan("");
}

}  // namespace

void addQuality(const MeshQualityReport& report, const PolyMesh& mesh, vtkUnstructuredGrid* grid) {
  for (const QualityMeasure& m : report.measures)
    addArray<vtkFloatArray>(grid->GetCellData(), m.name.c_str(), worstOfCells(mesh, m));
}

void packFacesOutside(const MeshQualityReport& report, const PolyMesh& mesh, vtkPolyData* surface) {
  surface->Initialize();
  const std::vector<Id> faces = facesOutside(report);
  packRows(mesh, faces, surface);
  vtkCellData* data = surface->GetCellData();
  const Id internal = mesh.internalFaces();
  std::vector<Id> broken(faces.size(), 0);
  for (const QualityMeasure& m : report.measures) {
    if (m.ofCells) continue;
    const std::vector<double> values = column<double>(faces, [&](Id f) { return valueOn(m, f); });
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Id row = faces[i] - m.first;
      const bool defined = row >= 0 && row < static_cast<Id>(m.values.size());
      if (defined && !m.holds(values[i])) ++broken[i];
    }
    addArray<vtkDoubleArray>(data, m.name.c_str(), values);
  }
  addArray<vtkTypeInt32Array>(data, "Face", faces);
  addArray<vtkTypeInt32Array>(data, "Owner", column<Id>(faces, [&](Id f) { return mesh.owner[f]; }));
  addArray<vtkTypeInt32Array>(
      data, "Neighbour", column<Id>(faces, [&](Id f) { return f < internal ? mesh.neighbour[f] : kNone; }));
  addArray<vtkTypeInt32Array>(data, "PatchId", column<Id>(faces, [&](Id f) {
                                return f < internal ? kNone : mesh.patch[f - internal];
                              }));
  addArray<vtkTypeInt32Array>(data, "Broken", broken);
  addStrings(surface->GetFieldData(), "PatchNames", mesh.patchNames);
}

void packWorstPlaces(const MeshQualityReport& report, const PolyMesh& mesh, vtkTable* table) {
  table->Initialize();
  vtkDataSetAttributes* rows = table->GetRowData();
  const std::vector<QualityPlace>& places = report.places;
  const auto measure = [&](const QualityPlace& p) -> const QualityMeasure& {
    return report.measures[p.measure];
  };
  using Place = const QualityPlace&;
  addStrings(rows, "Measure", column<std::string>(places, [&](Place p) { return measure(p).name; }));
  addArray<vtkDoubleArray>(rows, "Value", column<double>(places, [](Place p) { return p.value; }));
  addArray<vtkDoubleArray>(rows, "Limit", column<double>(places, [&](Place p) { return measure(p).limit; }));
  addArray<vtkTypeInt32Array>(rows, "Outside",
                              column<Id>(places, [&](Place p) { return Id(!measure(p).holds(p.value)); }));
  addArray<vtkTypeInt32Array>(rows, "Face", column<Id>(places, [](Place p) { return p.face; }));
  addArray<vtkTypeInt32Array>(rows, "Cell", column<Id>(places, [](Place p) { return p.cell; }));
  addArray<vtkTypeInt32Array>(rows, "Neighbour", column<Id>(places, [](Place p) { return p.neighbour; }));
  addStrings(rows, "Patch", column<std::string>(places, [&](Place p) {
               return p.patch == kNone ? std::string() : mesh.patchNames[p.patch];
             }));
  vtkNew<vtkDoubleArray> positions;
  positions->SetName("Position");
  positions->SetNumberOfComponents(3);
  for (Place p : places) positions->InsertNextTuple(p.position.data());
  rows->AddArray(positions);
}

void packHistograms(const MeshQualityReport& report, vtkTable* table) {
  table->Initialize();
  std::vector<std::string> names;
  std::vector<double> from, to;
  std::vector<Id> counts;
  for (std::size_t i = 0; i < report.histograms.size(); ++i) {
    const QualityHistogram& h = report.histograms[i];
    names.insert(names.end(), h.counts.size(), report.measures[i].name);
    from.insert(from.end(), h.edges.begin(), h.edges.end() - 1);
    to.insert(to.end(), h.edges.begin() + 1, h.edges.end());
    counts.insert(counts.end(), h.counts.begin(), h.counts.end());
  }
  addStrings(table->GetRowData(), "Measure", names);
  addArray<vtkDoubleArray>(table->GetRowData(), "From", from);
  addArray<vtkDoubleArray>(table->GetRowData(), "To", to);
  addArray<vtkTypeInt32Array>(table->GetRowData(), "Count", counts);
}

void packQualitySummary(const MeshQualityReport& report, vtkTable* table) {
  table->Initialize();
  vtkDataSetAttributes* rows = table->GetRowData();
  using Measure = const QualityMeasure&;
  const auto extreme = [](Measure m, bool largest) {
    double found = m.values.empty() ? std::nan("") : m.values[0];
    for (double v : m.values) found = largest ? std::max(found, v) : std::min(found, v);
    return found;
  };
  const std::vector<QualityMeasure>& all = report.measures;
  addStrings(rows, "Measure", column<std::string>(all, [](Measure m) { return m.name; }));
  addStrings(rows, "Of", column<std::string>(all, [](Measure m) { return m.ofCells ? "cells" : "faces"; }));
  addArray<vtkDoubleArray>(rows, "Minimum",
                           column<double>(all, [&](Measure m) { return extreme(m, false); }));
  addArray<vtkDoubleArray>(rows, "Maximum", column<double>(all, [&](Measure m) { return extreme(m, true); }));
  addArray<vtkDoubleArray>(rows, "Mean", column<double>(all, [](Measure m) { return m.mean; }));
  addArray<vtkDoubleArray>(rows, "Limit", column<double>(all, [](Measure m) { return m.limit; }));
  addArray<vtkTypeInt32Array>(rows, "Outside", column<Id>(all, [](Measure m) { return m.outside; }));
}

}  // namespace pm
