// SPDX-License-Identifier: BSD-3-Clause
#include "vtkValidMeshStage.h"

#include "MeshQuality.h"

vtkValidMeshStage::vtkValidMeshStage(int inputPorts, int geometryPort)
    : vtkMeshStage(inputPorts, geometryPort, 2) {
  const pm::QualityLimits defaults;
  this->MinimumVolume = defaults.minVolume;
  this->MinimumTet = defaults.minTet;
  this->MinimumEtaInternal = defaults.minEtaInternal;
  this->MinimumEtaBoundary = defaults.minEtaBoundary;
  this->MaximumAngleInternal = defaults.maxAngleInternal;
  this->MaximumAngleBoundary = defaults.maxAngleBoundary;
  this->MaximumWarpage = defaults.maxWarpage;
  this->MaximumSkewInternal = defaults.maxSkewInternal;
  this->MaximumSkewBoundary = defaults.maxSkewBoundary;
}

pm::QualityLimits vtkValidMeshStage::Limits() const {
  pm::QualityLimits limits;
  limits.minVolume = this->MinimumVolume;
  limits.minTet = this->MinimumTet;
  limits.minEtaInternal = this->MinimumEtaInternal;
  limits.minEtaBoundary = this->MinimumEtaBoundary;
  limits.maxAngleInternal = this->MaximumAngleInternal;
  limits.maxAngleBoundary = this->MaximumAngleBoundary;
  limits.maxWarpage = this->MaximumWarpage;
  limits.maxSkewInternal = this->MaximumSkewInternal;
  limits.maxSkewBoundary = this->MaximumSkewBoundary;
  return limits;
}

void vtkValidMeshStage::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MinimumVolume: " << this->MinimumVolume << "\n";
  os << indent << "MinimumTet: " << this->MinimumTet << "\n";
  os << indent << "MinimumEtaInternal: " << this->MinimumEtaInternal << "\n";
  os << indent << "MinimumEtaBoundary: " << this->MinimumEtaBoundary << "\n";
  os << indent << "MaximumAngleInternal: " << this->MaximumAngleInternal << "\n";
  os << indent << "MaximumAngleBoundary: " << this->MaximumAngleBoundary << "\n";
  os << indent << "MaximumWarpage: " << this->MaximumWarpage << "\n";
  os << indent << "MaximumSkewInternal: " << this->MaximumSkewInternal << "\n";
  os << indent << "MaximumSkewBoundary: " << this->MaximumSkewBoundary << "\n";
}
