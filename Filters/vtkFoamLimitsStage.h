// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkFoamLimitsStage
 * @brief a stage that keeps, or reports, OpenFOAM's further limits too
 *
 * These are the limits of checkMesh -allGeometry that moving nodes can break. Boundary layers are exempt:
 * they are thin beside the cells below on purpose.
 */
#pragma once

#include "vtkValidMeshStage.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkFoamLimitsStage : public vtkValidMeshStage {
 public:
  vtkAbstractTypeMacro(vtkFoamLimitsStage, vtkValidMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Smallest interpolation weight of an internal face as OpenFOAM defines it: 1/2 midway between its cells.
   */
  vtkSetClampMacro(MinimumFaceWeight, double, 0.0, 0.5);
  vtkGetMacro(MinimumFaceWeight, double);
  ///@}
  ///@{
  /** Smallest ratio of the volumes of an internal face's cells. */
  vtkSetClampMacro(MinimumVolumeRatio, double, 0.0, 1.0);
  vtkGetMacro(MinimumVolumeRatio, double);
  ///@}
  ///@{
  /** Smallest determinant of a cell's internal faces as OpenFOAM defines it: 1 for a cube. */
  vtkSetClampMacro(MinimumDeterminant, double, 0.0, 1.0);
  vtkGetMacro(MinimumDeterminant, double);
  ///@}

 protected:
  vtkFoamLimitsStage(int inputPorts, int geometryPort);
  pm::QualityLimits Limits() const override;

  double MinimumFaceWeight;
  double MinimumVolumeRatio;
  double MinimumDeterminant;

 private:
  vtkFoamLimitsStage(const vtkFoamLimitsStage&) = delete;
  void operator=(const vtkFoamLimitsStage&) = delete;
};
