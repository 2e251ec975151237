// SPDX-License-Identifier: BSD-3-Clause
// Feature curves as data that ParaView shows, and the user's own curves as the kernel takes them.
#pragma once

#include <vector>

#include "ResolveFeatures.h"

class vtkDataObject;
class vtkPolyData;

namespace pm {

/// A vertex for each corner, then a polyline for each curve. Cell arrays Kind (FeatureKind bits, 0 for
/// corners) and Curve (-1 for corners) int32, Length double.
void packCurves(const FeatureGraph& graph, vtkPolyData* lines);

/// A polyline for each unresolved part. Cell arrays Curve int32 (row of Detect Features' curves), Reason
/// uint8 (see Unresolved), Why string, Length and NeededSize double, lengths; NeededSize 0 = none is known.
void packUnresolved(const std::vector<UnresolvedFeature>& parts, vtkPolyData* lines);

/// The polylines of a polydata, or of all those in a composite; none when there is no object. Throws
/// InputError when it has no lines at all.
std::vector<std::vector<Vec3>> curvesFrom(vtkDataObject* object);

}  // namespace pm
