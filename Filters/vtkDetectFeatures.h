// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkDetectFeatures
 * @brief shows the feature curves of a geometry: what vtkResolveFeatures would put mesh edges on
 *
 * Inputs: the geometry; polylines on it that are features too (optional). Output: a polydata with a vertex
 * for each corner and a polyline for each curve, with the cell arrays Kind (bits: 1 sharp, 2 interface, 4
 * open, 8 non-manifold, 16 intersection, 32 given; 0 for corners), Curve (number of the curve, -1 for
 * corners) and Length. Lengths are in the units of the geometry, angles in degrees. Source: thesis
 * section 4.7.1.
 */
#pragma once

#include "vtkMeshStage.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkDetectFeatures : public vtkMeshStage {
 public:
  static vtkDetectFeatures* New();
  vtkTypeMacro(vtkDetectFeatures, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** As in vtkResolveFeatures; a gap tolerance of 0 finds no unstitched borders. */
  vtkSetClampMacro(SharpAngle, double, 0.0, 180.0);
  vtkGetMacro(SharpAngle, double);
  vtkSetClampMacro(CornerAngle, double, 0.0, 180.0);
  vtkGetMacro(CornerAngle, double);
  vtkSetMacro(Interfaces, bool);
  vtkGetMacro(Interfaces, bool);
  vtkBooleanMacro(Interfaces, bool);
  vtkSetMacro(OpenEdges, bool);
  vtkGetMacro(OpenEdges, bool);
  vtkBooleanMacro(OpenEdges, bool);
  vtkSetMacro(Intersections, bool);
  vtkGetMacro(Intersections, bool);
  vtkBooleanMacro(Intersections, bool);
  vtkSetClampMacro(GapTolerance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(GapTolerance, double);
  vtkSetClampMacro(ShortestCurve, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(ShortestCurve, double);
  ///@}

 protected:
  vtkDetectFeatures();
  ~vtkDetectFeatures() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  double SharpAngle;
  double CornerAngle;
  bool Interfaces;
  bool OpenEdges;
  bool Intersections;
  double GapTolerance;
  double ShortestCurve;

 private:
  vtkDetectFeatures(const vtkDetectFeatures&) = delete;
  void operator=(const vtkDetectFeatures&) = delete;
};
