// SPDX-License-Identifier: BSD-3-Clause
// Face and cell measures (thesis 4.3, eqs 4-3..4-27) and OpenFOAM's skewness; the limits every stage keeps.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

/// Table 5-1, eqs 4-21..4-28, and checkMesh's criteria. Angles in degrees; volumes in units of finestSize^3.
struct QualityLimits {
  double minVolume = 0.01;
  double minTet = 0.0;          ///< central tetrahedra, and OpenFOAM's face pyramids
  double minEtaInternal = 0.1;  ///< face degradation
  double minEtaBoundary = 0.1;
  double maxAngleInternal = 70;  ///< face normal against the line between cell centres
  double maxAngleBoundary = 71;
  double maxWarpage = 72;
  double maxSkewInternal = 3.8;   ///< OpenFOAM's definition; checkMesh fails at 4
  double maxSkewBoundary = 3.8;   ///< checkMesh draws no line between the two
  double minFaceWeight = 0.05;    ///< OpenFOAM's: 1/2 for a face midway between its cells
  double minVolumeRatio = 0.01;   ///< smaller over larger of a face's cells
  double minDeterminant = 0.001;  ///< OpenFOAM's, of a cell's internal faces: 1 for a cube
};

/// Worst values found in a mesh.
struct QualitySummary {
  double minVolume = 0, minTet = 0, minPyramid = 0;  ///< in finestSize^3
  double totalVolume = 0;                            ///< in the geometry's units
  double minEtaInternal = 1, minEtaBoundary = 1;
  double maxAngleInternal = 0, maxAngleBoundary = 0, maxWarpage = 0;
  double maxSkewInternal = 0, maxSkewBoundary = 0;
  double maxOpenness = 0;  ///< |sum of area vectors| / area of a cell
  Id violations = 0;       ///< faces and cells outside the limits
};

struct FaceMeasures {
  Vec3 centre = Vec3::Zero();  ///< eq 4-8
  Vec3 normal = Vec3::Zero();  ///< eq 4-9, length = projected area
  double eta = 0;              ///< smallest degradation of the central triangles, eq 4-13
  double cosWarpage = 1;       ///< cosine of eq 4-27
  double warpage() const;      ///< degrees, eq 4-27
};

/// points: the mesh's; row: the face's point ids. quick = true leaves eta at 0 and cosWarpage at 1.
FaceMeasures measureFace(const std::vector<Vec3>& points, Span<Id> row, bool quick = false);

struct CellMeasures {
  Vec3 centre = Vec3::Zero();  ///< eq 4-17
  double volume = 0;           ///< eq 4-19
  double minTet = 0;           ///< smallest central tetrahedron about centre, eq 4-22
  Vec3 foamCentre =
      Vec3::Zero();       ///< OpenFOAM's cell centre: the faces' pyramids about the mean of their centres
  double minPyramid = 0;  ///< smallest pyramid of a face over foamCentre; checkMesh fails below 0
};

/// Different points of each cell, ascending; what eq 4-16 averages.
Csr<Id> cellPoints(const PolyMesh& mesh);

/// Measures of one cell. pointsOfCell: its different points; forEachFace(body) calls body(row, sign, centre)
/// for each of its faces: the face's points, 1 when its normal leaves the cell and -1 otherwise, and its
/// centre (4-8).
template <class ForEachFace>
CellMeasures measureCell(const std::vector<Vec3>& points, Span<Id> pointsOfCell,
                         const ForEachFace& forEachFace);
/// The same for a cell of a mesh; faceCentre(f) is the centre of face f.
template <class FaceCentre>
CellMeasures measureCell(const PolyMesh& mesh, Id cell, Span<Id> facesOfCell, Span<Id> pointsOfCell,
                         const FaceCentre& faceCentre);

/// Degrees between a face's normal and a direction, eqs 4-25, 4-26; 180 when either has no length.
double faceAngle(const Vec3& normal, const Vec3& direction);
/// OpenFOAM's skewness of an internal and of a boundary face; the centres are the cells' foamCentre.
double internalSkewness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                        const Vec3& ownerCentre, const Vec3& neighbourCentre);
double boundarySkewness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                        const Vec3& ownerCentre);

/// Whether a value is within a limit; upper: the limit is the largest allowed value. What is not a number is
/// not, and a value equal to a lower limit of zero is not: a cell of no volume is no cell.
inline bool withinLimit(double value, double limit, bool upper) {
  return upper ? value <= limit : limit > 0 ? value >= limit : value > limit;
}

/// Whole-mesh measures; parallel, deterministic.
struct MeshMeasures {
  std::vector<FaceMeasures> faces;
  std::vector<CellMeasures> cells;
  std::vector<float> faceAngle;  // degrees, eqs 4-25, 4-26
  std::vector<float> faceSkew;
  std::vector<float> openness;  // #C |sum of area vectors| / sum of their lengths
};
MeshMeasures measure(const PolyMesh& mesh);
QualitySummary summarise(const PolyMesh& mesh, const MeshMeasures& measures, const QualityLimits& limits);
/// One line a violated limit, worst first, for messages; empty when valid.
std::string describeViolations(const PolyMesh& mesh, const MeshMeasures& measures,
                               const QualityLimits& limits);

// ---- implementation of the templates
// ------------------------------------------------------------------------------

/// OpenFOAM's view of a cell, as its primitiveMesh computes it: foamCentre and minPyramid.
template <class ForEachFace>
void measurePyramids(const std::vector<Vec3>& points, const Vec3& origin, const ForEachFace& forEachFace,
                     CellMeasures& cell) {
  Vec3 estimate = Vec3::Zero();
  double count = 0;
  forEachFace([&](Span<Id>, int, const Vec3& faceCentre) {
    estimate += faceCentre - origin;
    ++count;
  });
  estimate /= count;
  // Sums over the faces as N: area vectors out of the cell.
  const auto forEachPyramid = [&](const auto& body) {
    forEachFace([&](Span<Id> row, int sign, const Vec3& faceCentre) {
      Vec3 twice = Vec3::Zero(), a = points[row[row.size() - 1]] - faceCentre;
      for (Id p : row) {
        const Vec3 b = points[p] - faceCentre;
        twice += a.cross(b);
        a = b;
      }
      body(Vec3(0.5 * sign * twice), Vec3(faceCentre - origin));
    });
  };
  double volume = 0;
  Vec3 moment = Vec3::Zero();
  forEachPyramid([&](const Vec3& area, const Vec3& at) {
    const double pyramid = area.dot(at - estimate);
    volume += pyramid;
    moment += pyramid * (0.75 * at + 0.25 * estimate);
  });
  const Vec3 centre = volume != 0 ? Vec3(moment / volume) : estimate;
  cell.minPyramid = std::numeric_limits<double>::infinity();
  forEachPyramid([&](const Vec3& area, const Vec3& at) {
    cell.minPyramid = std::min(cell.minPyramid, area.dot(at - centre) / 3);
  });
  cell.foamCentre = origin + centre;
}

template <class ForEachFace>
CellMeasures measureCell(const std::vector<Vec3>& points, Span<Id> pointsOfCell,
                         const ForEachFace& forEachFace) {
  // Everything is relative to one of the cell's points, so that a far origin costs no digits.
  const Vec3 origin = points[pointsOfCell[0]];
  Vec3 average = Vec3::Zero();
  for (Id p : pointsOfCell) average += points[p] - origin;
  average /= static_cast<double>(pointsOfCell.size());

  const auto forEachTet = [&](const Vec3& apex, const auto& body) {
    forEachFace([&](Span<Id> row, int sign, const Vec3& faceCentre) {
      const Vec3 centre = faceCentre - origin - apex;
      const double factor = sign / 6.0;
      Vec3 a = points[row[row.size() - 1]] - origin - apex;
      for (Id p : row) {
        const Vec3 b = points[p] - origin - apex;
        body(factor * a.cross(b).dot(centre), a, b, centre);
        a = b;
      }
    });
  };
  CellMeasures cell;
  measurePyramids(points, origin, forEachFace, cell);
  Vec3 moment = Vec3::Zero();
  forEachTet(average, [&](double tet, const Vec3& a, const Vec3& b, const Vec3& c) {
    cell.volume += tet;
    moment += tet * (a + b + c);
  });
  const Vec3 centre = cell.volume != 0 ? Vec3(average + moment / (4 * cell.volume)) : average;
  cell.minTet = std::numeric_limits<double>::infinity();
  forEachTet(centre, [&](double tet, const Vec3&, const Vec3&, const Vec3&) {
    cell.minTet = std::min(cell.minTet, tet);
  });
  cell.centre = origin + centre;
  return cell;
}

template <class FaceCentre>
CellMeasures measureCell(const PolyMesh& mesh, Id cell, Span<Id> facesOfCell, Span<Id> pointsOfCell,
                         const FaceCentre& faceCentre) {
  return measureCell(mesh.points, pointsOfCell, [&](const auto& body) {
    for (Id f : facesOfCell) body(mesh.faces[f], mesh.owner[f] == cell ? 1 : -1, faceCentre(f));
  });
}

}  // namespace pm
