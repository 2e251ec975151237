// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDummyLayer.h"

#include "DummyLayer.h"
#include "MeshPacking.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkDummyLayer);

vtkDummyLayer::vtkDummyLayer() : vtkFoamLimitsStage(1, -1) {
  this->Thickness = pm::DummyLayerOptions().thickness;
}

pm::DummyLayerOptions vtkDummyLayer::Options() const {
  pm::DummyLayerOptions options;
  options.thickness = this->Thickness;
  options.limits = this->Limits();
  return options;
}

void vtkDummyLayer::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                        pm::Monitor& monitor) {
  pm::PolyMesh front =
      pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Dummy Layer", {pm::Stage::Front});
  DoneWith(inputs[0]);
  const pm::PolyMesh result = pm::dummyLayer(std::move(front), this->Options(), monitor);
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

void vtkDummyLayer::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Thickness: " << this->Thickness << "\n";
}
