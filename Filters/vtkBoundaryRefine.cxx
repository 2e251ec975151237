// SPDX-License-Identifier: BSD-3-Clause
#include "vtkBoundaryRefine.h"

#include "BoundaryRefine.h"
#include "LayerPacking.h"
#include "MeshPacking.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkBoundaryRefine);

vtkBoundaryRefine::vtkBoundaryRefine()
    : vtkValidMeshStage(1, -1), Report(std::make_unique<pm::BoundaryRefineReport>()) {
  const pm::BoundaryRefineOptions defaults;
  this->Layers = defaults.layers;
  this->ExpansionRatio = defaults.expansion;
  this->FirstHeight = defaults.firstHeight;
  this->TotalThickness = defaults.thickness;
  this->YPlus = defaults.yPlus;
  this->FlowSpeed = defaults.flow.speed;
  this->FlowLength = defaults.flow.length;
  this->KinematicViscosity = defaults.flow.viscosity;
  this->EvenGrowth = defaults.end == pm::LayerEnd::EvenGrowth;
  this->MakeRoom = defaults.makeRoom;
  this->SetNumberOfOutputPorts(LAYERS + 1);
}

vtkBoundaryRefine::~vtkBoundaryRefine() = default;

int vtkBoundaryRefine::FillOutputPortInformation(int port, vtkInformation* info) {
  if (port != LAYERS) return this->Superclass::FillOutputPortInformation(port, info);
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

void vtkBoundaryRefine::AddPatchLayer(const char* patches, int layers, double expansionRatio,
                                      double firstHeight, double totalThickness, double yPlus) {
  pm::LayerSpec spec;
  spec.layers = layers;
  spec.expansion = expansionRatio;
  spec.firstHeight = firstHeight;
  spec.thickness = totalThickness;
  spec.yPlus = yPlus;
  this->PatchLayers.push_back({patches ? patches : "", spec});
  this->Modified();
}

void vtkBoundaryRefine::ClearPatchLayers() {
  if (this->PatchLayers.empty()) return;
  this->PatchLayers.clear();
  this->Modified();
}

int vtkBoundaryRefine::GetNumberOfPatchLayers() const { return static_cast<int>(this->PatchLayers.size()); }

pm::BoundaryRefineOptions vtkBoundaryRefine::Options() const {
  pm::BoundaryRefineOptions options;
  options.layers = this->Layers;
  options.expansion = this->ExpansionRatio;
  options.firstHeight = this->FirstHeight;
  options.thickness = this->TotalThickness;
  options.yPlus = this->YPlus;
  options.flow.speed = this->FlowSpeed;
  options.flow.length = this->FlowLength;
  options.flow.viscosity = this->KinematicViscosity;
  options.patches = this->PatchLayers;
  options.end = this->EvenGrowth ? pm::LayerEnd::EvenGrowth : pm::LayerEnd::LastFills;
  options.makeRoom = this->MakeRoom;
  options.limits = this->Limits();
  return options;
}

vtkIdType vtkBoundaryRefine::GetWallFaces() const { return this->Report->wallFaces; }

vtkIdType vtkBoundaryRefine::GetFacesWithLayers(int layers) const {
  const std::vector<pm::Id>& faces = this->Report->facesByLayers;
  return layers >= 1 && layers <= static_cast<int>(faces.size()) ? faces[layers - 1] : 0;
}

void vtkBoundaryRefine::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                            pm::Monitor& monitor) {
  *this->Report = {};
  pm::PolyMesh input = pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Boundary Refine",
                                      {pm::Stage::Resolved, pm::Stage::Projected});
  DoneWith(inputs[0]);
  const pm::PolyMesh result =
      pm::boundaryRefine(std::move(input), this->Options(), monitor, this->Report.get());
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
  pm::packLayers(*this->Report, boundary);
  pm::packLayerTable(*this->Report, vtkTable::SafeDownCast(this->GetOutputDataObject(LAYERS)));
}

void vtkBoundaryRefine::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Layers: " << this->Layers << "\n";
  os << indent << "ExpansionRatio: " << this->ExpansionRatio << "\n";
  os << indent << "FirstHeight: " << this->FirstHeight << "\n";
  os << indent << "TotalThickness: " << this->TotalThickness << "\n";
  os << indent << "YPlus: " << this->YPlus << "\n";
  os << indent << "FlowSpeed: " << this->FlowSpeed << "\n";
  os << indent << "FlowLength: " << this->FlowLength << "\n";
  os << indent << "KinematicViscosity: " << this->KinematicViscosity << "\n";
  os << indent << "PatchLayers: " << this->GetNumberOfPatchLayers() << "\n";
  os << indent << "EvenGrowth: " << this->EvenGrowth << "\n";
  os << indent << "MakeRoom: " << this->MakeRoom << "\n";
  os << indent << "WallFaces: " << this->GetWallFaces() << "\n";
}
