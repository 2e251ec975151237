// SPDX-License-Identifier: BSD-3-Clause
// What boundary layers were made, as VTK data: on the boundary's faces and as a table.
#pragma once

class vtkPolyData;
class vtkTable;

namespace pm {

struct BoundaryRefineReport;

/// Cell arrays of the boundary, 0 on faces that are no wall: Layers uint8; LayerReason uint8, why a face has
/// fewer than wanted, 0 = it has not; FirstHeight, FirstHeightWanted and LayerThickness double, lengths;
/// GrowthInside and GrowthOutside double, ratios of heights: the largest from a layer to the next, and that
/// from the last layer to what lies behind it; 0 = there is none.
/// Field array LayerReasonNames string: the reasons in words. None of them when the report holds no faces.
void packLayers(const BoundaryRefineReport& report, vtkPolyData* boundary);

/// One row a wall patch that has faces, and one for all of them where there are several. Columns: Patch,
/// Faces, Area, LayersWanted, Layers (mean), AllLayers, Covered, AsWanted (%), FirstHeightWanted,
/// FirstHeightMean, FirstHeightLeast, GrowthInside95 (what 95% of the area have less of), GrowthOutside
/// (median), GrowthOutside95, Thickness (mean), and a count of faces for each reason that occurs.
void packLayerTable(const BoundaryRefineReport& report, vtkTable* table);

}  // namespace pm
