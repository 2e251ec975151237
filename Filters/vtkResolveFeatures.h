// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkResolveFeatures
 * @brief stage 5: mesh edges onto sharp edges and patch interfaces, nodes onto corners
 *
 * Input 0: the grid of vtkProject; input 1: the geometry; input 2 (optional): polylines on it that are
 * features too. Output 2: a polyline for each part of a feature that no mesh edges lie on, with the cell
 * arrays Curve, Reason (see Unresolved in ResolveFeatures.h), Why (the same in words, or the limit that was
 * in the way), Length and NeededSize, the length of edges that would resolve it (0 = none is known). Source:
 * thesis section 4.7. Lengths are in the units of the geometry, angles in degrees.
 */
#pragma once

#include "vtkFoamLimitsStage.h"

namespace pm {
struct ResolveFeaturesOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkResolveFeatures : public vtkFoamLimitsStage {
 public:
  static vtkResolveFeatures* New();
  vtkTypeMacro(vtkResolveFeatures, vtkFoamLimitsStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Angle between the planes of two triangles from which their edge is sharp, degrees. */
  vtkSetClampMacro(SharpAngle, double, 0.0, 180.0);
  vtkGetMacro(SharpAngle, double);
  ///@}
  ///@{
  /** Angle a feature curve may turn at a point before the point becomes a corner, degrees. */
  vtkSetClampMacro(CornerAngle, double, 0.0, 180.0);
  vtkGetMacro(CornerAngle, double);
  ///@}
  ///@{
  /** Edges between patches are features. */
  vtkSetMacro(Interfaces, bool);
  vtkGetMacro(Interfaces, bool);
  vtkBooleanMacro(Interfaces, bool);
  ///@}
  ///@{
  /** Every open edge is a feature. */
  vtkSetMacro(OpenEdges, bool);
  vtkGetMacro(OpenEdges, bool);
  vtkBooleanMacro(OpenEdges, bool);
  ///@}
  ///@{
  /** Curves where the surface cuts itself at more than the sharp angle are features. */
  vtkSetMacro(Intersections, bool);
  vtkGetMacro(Intersections, bool);
  vtkBooleanMacro(Intersections, bool);
  ///@}
  ///@{
  /** An open edge this close to another surface that meets it at an angle is a feature, length. */
  vtkSetClampMacro(GapTolerance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(GapTolerance, double);
  ///@}
  ///@{
  /** Shorter open-ended curves that join nothing are dropped, length. */
  vtkSetClampMacro(ShortestCurve, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(ShortestCurve, double);
  ///@}
  ///@{
  /** Most rounds of moving nodes onto features; fewer are done where another is not worth it. */
  vtkSetClampMacro(Rounds, int, 1, 1000);
  vtkGetMacro(Rounds, int);
  ///@}

  ///@{
  /** What the last run reached: length of all feature curves and of the parts that mesh edges lie on;
   * corners. */
  vtkGetMacro(FeatureLength, double);
  vtkGetMacro(ResolvedLength, double);
  vtkGetMacro(Corners, vtkIdType);
  vtkGetMacro(ResolvedCorners, vtkIdType);
  ///@}

  enum PortType { UNRESOLVED = 2 };

  /** The properties, and the polylines if any, as the kernel takes them. */
  pm::ResolveFeaturesOptions Options(vtkDataObject* curves) const;

 protected:
  vtkResolveFeatures();
  ~vtkResolveFeatures() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  double SharpAngle;
  double CornerAngle;
  bool Interfaces;
  bool OpenEdges;
  bool Intersections;
  double GapTolerance;
  double ShortestCurve;
  int Rounds;

  double FeatureLength = 0;
  double ResolvedLength = 0;
  vtkIdType Corners = 0;
  vtkIdType ResolvedCorners = 0;

 private:
  vtkResolveFeatures(const vtkResolveFeatures&) = delete;
  void operator=(const vtkResolveFeatures&) = delete;
};
