// SPDX-License-Identifier: BSD-3-Clause
// OpenFOAM's measures of faces and cells as checkMesh -allGeometry takes them, by the formulas of its
// primitiveMeshTools and polyMeshTetDecomposition (version 1912), on the centres and area vectors of
// MeshQuality. Its face centre is eq 4-8, its area vector eq 4-9, its cell centre CellMeasures::foamCentre;
// skewness, face pyramids and volumes are in MeshQuality already, because the stages keep limits on them.
//
// All measures are free of units and do not change with scale, but for areas and degrees.
#pragma once

#include <array>

#include "MeshQuality.h"

namespace pm {

/// Those limits of checkMesh that are not in QualityLimits; angles in degrees.
struct FoamLimits {
  double maxNonOrthogonality = 70;  ///< checkMesh counts faces above as severely non-orthogonal
  double minFaceTet = 1e-30;        ///< quality of a face's decomposition tetrahedra
  double minFlatness = 0.8;
  double maxFaceConcavity = 10;
  double maxAspectRatio = 1000;
  double maxCellConcavity = 90;  ///< 90: any; a polyhedron with coplanar faces is concave to checkMesh
};

/// checkMesh calls a cell concave when one of its face centres lies less than this (as a sine) behind
/// another face's plane.
constexpr double kPlanarSine = 1e-6;

/// Directions that a solver works in; a mesh between OpenFOAM's empty patches has two.
using Directions = std::array<bool, 3>;

/// Interpolation weight of an internal face: 1/2 midway between its cells' planes, 0 when one is empty.
double faceWeight(const FaceMeasures& face, const Vec3& ownerCentre, const Vec3& neighbourCentre);
/// Smaller over larger volume of an internal face's cells.
double volumeRatio(double ownerVolume, double neighbourVolume);
/// Length of the area vector over the area of the central triangles: 1 flat, 0 folded onto itself.
double faceFlatness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face);
/// Largest angle by which consecutive edges turn against the face's normal, degrees; 0 when convex.
double faceConcavity(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face);
/// Volume of a tetrahedron over that of a regular one in its circumsphere; negative when inverted.
double tetQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Worst quality of a face's tetrahedra: about its centre, and about the base point that suits its cells
/// best. neighbourCentre: null on the boundary.
double faceTetQuality(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                      const Vec3& ownerCentre, const Vec3* neighbourCentre);
/// Smallest volume of the same tetrahedra, which has the same sign and costs less. The search for a base
/// point ends at the first one that gives more than `enough`.
double faceTetVolume(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                     const Vec3& ownerCentre, const Vec3* neighbourCentre, double enough);

/// Of a cell whose internal faces have these area vectors: 1 for a cube, small where the gradient is
/// ill-posed.
double cellDeterminant(const Vec3* areas, std::size_t count, const Directions& solved = {true, true, true});

/// Measures of a cell from its faces' area vectors, the volume and which faces are internal.
struct FoamCell {
  double aspectRatio = 1;
  double determinant = 0;  ///< cellDeterminant
  double concavity = 0;    ///< degrees by which a face's centre lies before another face; convex: below 0
};
FoamCell measureFoamCell(const PolyMesh& mesh, const MeshMeasures& measures, Id cell, Span<Id> facesOfCell,
                         const Directions& solved);

/// Whole-mesh measures; parallel, deterministic. #F faces, #I internal faces, #C cells.
struct FoamMeasures {
  std::vector<double> nonOrthogonality;  // #I degrees
  std::vector<double> weight;            // #I
  std::vector<double> volumeRatio;       // #I
  std::vector<double> skewness;          // #F in double, MeshQuality's formula
  std::vector<double> flatness;          // #F 1 for a triangle
  std::vector<double> concavity;         // #F degrees
  std::vector<double> tet;               // #F
  std::vector<FoamCell> cells;           // #C
  double meanNonOrthogonality = 0;       ///< the angle of the mean cosine, as checkMesh gives it
  double meanFlatness = 1;               ///< over faces of more than three points
  Id concaveCells = 0;                   ///< as checkMesh counts them
};
FoamMeasures measureFoam(const PolyMesh& mesh, const MeshMeasures& measures, const Directions& solved,
                         Monitor& monitor);

}  // namespace pm
