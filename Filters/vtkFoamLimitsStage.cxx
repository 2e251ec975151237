// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFoamLimitsStage.h"

#include "MeshQuality.h"

vtkFoamLimitsStage::vtkFoamLimitsStage(int inputPorts, int geometryPort)
    : vtkValidMeshStage(inputPorts, geometryPort) {
  const pm::QualityLimits defaults;
  this->MinimumFaceWeight = defaults.minFaceWeight;
  this->MinimumVolumeRatio = defaults.minVolumeRatio;
  this->MinimumDeterminant = defaults.minDeterminant;
}

pm::QualityLimits vtkFoamLimitsStage::Limits() const {
  pm::QualityLimits limits = this->Superclass::Limits();
  limits.minFaceWeight = this->MinimumFaceWeight;
  limits.minVolumeRatio = this->MinimumVolumeRatio;
  limits.minDeterminant = this->MinimumDeterminant;
  return limits;
}

void vtkFoamLimitsStage::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MinimumFaceWeight: " << this->MinimumFaceWeight << "\n";
  os << indent << "MinimumVolumeRatio: " << this->MinimumVolumeRatio << "\n";
  os << indent << "MinimumDeterminant: " << this->MinimumDeterminant << "\n";
}
