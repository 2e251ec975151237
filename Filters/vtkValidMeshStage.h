// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkValidMeshStage
 * @brief a stage that keeps every cell within the validity limits
 *
 * The limits are those of Table 5-1 and eqs 4-21..4-28 of the thesis and of OpenFOAM's checkMesh. Angles are
 * degrees, volumes fractions of the smallest octree cell's.
 */
#pragma once

#include "vtkMeshStage.h"

namespace pm {
struct QualityLimits;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkValidMeshStage : public vtkMeshStage {
 public:
  vtkAbstractTypeMacro(vtkValidMeshStage, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Smallest volume of a cell (eq 4-21), in volumes of the smallest octree cell. */
  vtkSetClampMacro(MinimumVolume, double, 0.0, 1.0);
  vtkGetMacro(MinimumVolume, double);
  ///@}
  ///@{
  /** Smallest volume of a central tetrahedron (eq 4-22), in volumes of the smallest octree cell. */
  vtkSetClampMacro(MinimumTet, double, 0.0, 1.0);
  vtkGetMacro(MinimumTet, double);
  ///@}
  ///@{
  /** Smallest face degradation (eqs 4-13, 4-23, 4-24): 0 = folded, 1 = regular. */
  vtkSetClampMacro(MinimumEtaInternal, double, 0.0, 1.0);
  vtkGetMacro(MinimumEtaInternal, double);
  vtkSetClampMacro(MinimumEtaBoundary, double, 0.0, 1.0);
  vtkGetMacro(MinimumEtaBoundary, double);
  ///@}
  ///@{
  /** Largest angle of a face's normal against the line between cell centres (eqs 4-25, 4-26), degrees. */
  vtkSetClampMacro(MaximumAngleInternal, double, 0.0, 90.0);
  vtkGetMacro(MaximumAngleInternal, double);
  vtkSetClampMacro(MaximumAngleBoundary, double, 0.0, 90.0);
  vtkGetMacro(MaximumAngleBoundary, double);
  ///@}
  ///@{
  /** Largest warpage of a face (eq 4-27), degrees. */
  vtkSetClampMacro(MaximumWarpage, double, 0.0, 90.0);
  vtkGetMacro(MaximumWarpage, double);
  ///@}
  ///@{
  /** Largest skewness as OpenFOAM defines it; checkMesh fails at 4 inside and 20 on the boundary. */
  vtkSetClampMacro(MaximumSkewInternal, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MaximumSkewInternal, double);
  vtkSetClampMacro(MaximumSkewBoundary, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MaximumSkewBoundary, double);
  ///@}

 protected:
  vtkValidMeshStage(int inputPorts, int geometryPort);
  virtual pm::QualityLimits Limits() const;

  double MinimumVolume;
  double MinimumTet;
  double MinimumEtaInternal;
  double MinimumEtaBoundary;
  double MaximumAngleInternal;
  double MaximumAngleBoundary;
  double MaximumWarpage;
  double MaximumSkewInternal;
  double MaximumSkewBoundary;

 private:
  vtkValidMeshStage(const vtkValidMeshStage&) = delete;
  void operator=(const vtkValidMeshStage&) = delete;
};
