// SPDX-License-Identifier: BSD-3-Clause
// Every measure of a mesh in one list: values, limit, how many are outside, the worst places, a histogram.
//
// The formulas are those of MeshQuality (the thesis' eqs 4-3..4-27) and FoamQuality (checkMesh's); this part
// only lists them. All work is linear in the mesh but for sorting the few worst places.
#pragma once

#include <string>
#include <vector>

#include "FoamQuality.h"

namespace pm {

/// One measure of all cells, all faces, or the internal or the boundary faces.
struct QualityMeasure {
  std::string name;
  bool ofCells = false;
  bool upper = false;  ///< the limit is the largest allowed value
  double limit = 0;
  Id first = 0;                // cell or face of values[0]
  std::vector<double> values;  // one for each cell or face from first on
  double mean = 0;
  Id outside = 0;  ///< values that do not hold the limit

  bool holds(double value) const;
  /// Whether a is worse than b; what is not a number is worst.
  bool worse(double a, double b) const;
};

struct QualityPlace {
  Id measure = 0;  ///< row of MeshQualityReport::measures
  double value = 0;
  Id face = kNone;  ///< kNone for a measure of cells
  Id cell = 0;      ///< of a face: its owner
  Id neighbour = kNone;
  Id patch = kNone;  ///< of a boundary face
  Vec3 position = Vec3::Zero();
};

struct QualityHistogram {
  std::vector<double> edges;  // one more than bins
  std::vector<Id> counts;
};

struct MeshQualityReportOptions {
  QualityLimits limits;
  FoamLimits foam;
  Directions solved{true, true, true};
  Id worstPlaces = 10;  ///< of each measure
  Id bins = 40;         ///< of each histogram
};

struct MeshQualityReport {
  std::vector<QualityMeasure> measures;
  std::vector<QualityPlace> places;          // by measure, worst first
  std::vector<QualityHistogram> histograms;  // one for each measure
  Id concaveCells = 0;                       ///< as checkMesh counts them

  const QualityMeasure& measure(const std::string& name) const;  ///< throws InternalError when there is none
};

/// A mesh of prisms that were split into layers is thin on purpose, and a mesh that is not the suite's has no
/// smallest octree cell: from both, volumes and degradation are only asked to be positive.
MeshQualityReport reportMeshQuality(const PolyMesh& mesh, const MeshQualityReportOptions& options,
                                    Monitor& monitor);

/// A measure for each cell: its own, or the worst of its faces; NaN for a cell that has none.
std::vector<float> worstOfCells(const PolyMesh& mesh, const QualityMeasure& measure);

/// Faces outside a limit on faces, ascending.
std::vector<Id> facesOutside(const MeshQualityReport& report);

/// Equal bins from the smallest to the largest value; equal ratios when all are above 0 and span more than
/// three decades.
QualityHistogram histogram(const std::vector<double>& values, Id bins);

}  // namespace pm
