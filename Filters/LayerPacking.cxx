// SPDX-License-Identifier: BSD-3-Clause
#include "LayerPacking.h"

#include <algorithm>

#include "BoundaryRefine.h"
#include "GridArrays.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTypeInt32Array.h"
#include "vtkUnsignedCharArray.h"

namespace pm {
namespace {

void addDoubles(const BoundaryRefineReport& report, vtkFieldData* rows, const char* name,
                double PatchCoverage::*member, double scale = 1) {
  addArray<vtkDoubleArray>(
      rows, name, column<double>(report.patches, [&](const PatchCoverage& p) { return scale * p.*member; }));
}

}  // namespace

void packLayers(const BoundaryRefineReport& report, vtkPolyData* boundary) {
  const WallFaceLayers& faces = report.faces;
  if (faces.layers.empty()) return;
  vtkCellData* data = boundary->GetCellData();
  std::vector<std::uint8_t> reasons;
  for (LayerReason reason : faces.reason) reasons.push_back(static_cast<std::uint8_t>(reason));
  addArray<vtkUnsignedCharArray>(data, "Layers", faces.layers);
  addArray<vtkUnsignedCharArray>(data, "LayerReason", reasons);
  addArray<vtkDoubleArray>(data, "FirstHeight", faces.firstHeight);
  addArray<vtkDoubleArray>(data, "FirstHeightWanted", faces.wantedFirst);
  addArray<vtkDoubleArray>(data, "LayerThickness", faces.thickness);
  addArray<vtkDoubleArray>(data, "GrowthInside", faces.growthInside);
  addArray<vtkDoubleArray>(data, "GrowthOutside", faces.growthOutside);
  std::vector<std::string> names;
  for (int i = 0; i < kLayerReasons; ++i) names.emplace_back(describe(static_cast<LayerReason>(i)));
  addStrings(boundary->GetFieldData(), "LayerReasonNames", names);
}

void packLayerTable(const BoundaryRefineReport& report, vtkTable* table) {
  table->Initialize();
  vtkDataSetAttributes* rows = table->GetRowData();
  constexpr double kPercent = 100;
  addStrings(rows, "Patch",
             column<std::string>(report.patches, [](const PatchCoverage& p) { return p.name; }));
  addArray<vtkTypeInt32Array>(rows, "Faces",
                              column<Id>(report.patches, [](const PatchCoverage& p) { return p.faces; }));
  addDoubles(report, rows, "Area", &PatchCoverage::area);
  addArray<vtkTypeInt32Array>(rows, "LayersWanted", column<Id>(report.patches, [](const PatchCoverage& p) {
                                return p.wantedLayers;
                              }));
  addDoubles(report, rows, "Layers", &PatchCoverage::layers);
  addDoubles(report, rows, "AllLayers", &PatchCoverage::allLayers, kPercent);
  addDoubles(report, rows, "Covered", &PatchCoverage::covered, kPercent);
  addDoubles(report, rows, "AsWanted", &PatchCoverage::asWanted, kPercent);
  addDoubles(report, rows, "FirstHeightWanted", &PatchCoverage::wantedFirst);
  addDoubles(report, rows, "FirstHeightMean", &PatchCoverage::meanFirst);
  addDoubles(report, rows, "FirstHeightLeast", &PatchCoverage::minFirst);
  addDoubles(report, rows, "GrowthInside95", &PatchCoverage::growthInside95);
  addDoubles(report, rows, "GrowthOutside", &PatchCoverage::growthOutside);
  addDoubles(report, rows, "GrowthOutside95", &PatchCoverage::growthOutside95);
  addDoubles(report, rows, "Thickness", &PatchCoverage::thickness);
  for (int i = 1; i < kLayerReasons; ++i) {
    const auto counts = column<Id>(report.patches, [i](const PatchCoverage& p) { return p.byReason[i]; });
    if (std::any_of(counts.begin(), counts.end(), [](Id n) { return n > 0; }))
      addArray<vtkTypeInt32Array>(rows, describe(static_cast<LayerReason>(i)), counts);
  }
}

}  // namespace pm
