// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkMeshQualityReport
 * @brief measures a mesh by the thesis' and by OpenFOAM's definitions and lists where it is worst
 *
 * Input: the grid of any stage from vtkPaintFront on, or any vtkUnstructuredGrid of tetrahedra, pyramids,
 * wedges, hexahedra, voxels and polyhedra. Outputs: 0 the grid with a cell array for each measure (for a
 * measure of faces the worst of the cell's), 1 the faces outside a limit, 2 a table of the worst places of
 * each measure, 3 a table of histograms, 4 a table with a row for each measure: range, mean, limit, how many
 * are outside. Volumes are in those of the smallest octree cell; of a grid that is not the suite's, in its
 * own units. Source: thesis section 4.3; OpenFOAM's checkMesh -allGeometry.
 */
#pragma once

#include "vtkFoamLimitsStage.h"

namespace pm {
struct MeshQualityReport;
struct MeshQualityReportOptions;
}  // namespace pm

class PROJECTIONMESHERFILTERS_EXPORT vtkMeshQualityReport : public vtkFoamLimitsStage {
 public:
  static vtkMeshQualityReport* New();
  vtkTypeMacro(vtkMeshQualityReport, vtkFoamLimitsStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Ports { MESH, FACES, WORST, HISTOGRAMS, SUMMARY };
  enum EmptyDirections { NONE, X, Y, Z };

  ///@{
  /** Largest angle between the normal of an internal face and the line between its cells' centres as OpenFOAM
   * defines them, degrees. */
  vtkSetClampMacro(MaximumNonOrthogonality, double, 0.0, 180.0);
  vtkGetMacro(MaximumNonOrthogonality, double);
  ///@}
  ///@{
  /** Smallest quality of the tetrahedra a face is decomposed into, about its centre and about its best base
   * point. */
  vtkSetClampMacro(MinimumFaceTet, double, 0.0, 1.0);
  vtkGetMacro(MinimumFaceTet, double);
  ///@}
  ///@{
  /** Smallest ratio of a face's projected to its actual area. */
  vtkSetClampMacro(MinimumFlatness, double, 0.0, 1.0);
  vtkGetMacro(MinimumFlatness, double);
  ///@}
  ///@{
  /** Largest angle by which consecutive edges of a face turn inwards, degrees. */
  vtkSetClampMacro(MaximumFaceConcavity, double, 0.0, 90.0);
  vtkGetMacro(MaximumFaceConcavity, double);
  ///@}
  ///@{
  /** Largest aspect ratio of a cell. */
  vtkSetClampMacro(MaximumAspectRatio, double, 1.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MaximumAspectRatio, double);
  ///@}
  ///@{
  /** Largest angle by which a face's centre of a cell stands before the plane of another of its faces,
   * degrees; below 0 all cells must be convex. */
  vtkSetClampMacro(MaximumCellConcavity, double, -90.0, 90.0);
  vtkGetMacro(MaximumCellConcavity, double);
  ///@}
  ///@{
  /** Direction a two-dimensional mesh, one cell thick, is not solved in; NONE for any other mesh. */
  vtkSetClampMacro(EmptyDirection, int, NONE, Z);
  vtkGetMacro(EmptyDirection, int);
  ///@}
  ///@{
  /** Places of each measure in the table of the worst. */
  vtkSetClampMacro(WorstPlaces, int, 0, VTK_INT_MAX);
  vtkGetMacro(WorstPlaces, int);
  ///@}
  ///@{
  /** Bins of each histogram. */
  vtkSetClampMacro(Bins, int, 1, 10000);
  vtkGetMacro(Bins, int);
  ///@}
  /** Cells that checkMesh calls concave, found by the last run. */
  vtkGetMacro(ConcaveCells, vtkIdType);

 protected:
  vtkMeshQualityReport();
  ~vtkMeshQualityReport() override = default;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* faces,
           pm::Monitor& monitor) override;

  double MaximumNonOrthogonality;
  double MinimumFaceTet;
  double MinimumFlatness;
  double MaximumFaceConcavity;
  double MaximumAspectRatio;
  double MaximumCellConcavity;
  int EmptyDirection = NONE;
  int WorstPlaces;
  int Bins;
  vtkIdType ConcaveCells = 0;

 private:
  vtkMeshQualityReport(const vtkMeshQualityReport&) = delete;
  void operator=(const vtkMeshQualityReport&) = delete;

  pm::MeshQualityReportOptions Options() const;
};
