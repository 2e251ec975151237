// SPDX-License-Identifier: BSD-3-Clause
#include "vtkBoundaryRefine.h"

#include "BoundaryRefine.h"
#include "MeshPacking.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkBoundaryRefine);

vtkBoundaryRefine::vtkBoundaryRefine() : vtkValidMeshStage(1, -1) {
  const pm::BoundaryRefineOptions defaults;
  this->Layers = defaults.layers;
  this->ExpansionRatio = defaults.expansion;
  this->FirstHeight = defaults.firstHeight;
}

pm::BoundaryRefineOptions vtkBoundaryRefine::Options() const {
  pm::BoundaryRefineOptions options;
  options.layers = this->Layers;
  options.expansion = this->ExpansionRatio;
  options.firstHeight = this->FirstHeight;
  options.limits = this->Limits();
  return options;
}

vtkIdType vtkBoundaryRefine::GetFacesWithLayers(int layers) const {
  const bool known = layers >= 1 && layers <= static_cast<int>(this->FacesByLayers.size());
  return known ? this->FacesByLayers[layers - 1] : 0;
}

void vtkBoundaryRefine::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                            pm::Monitor& monitor) {
  this->WallFaces = 0;
  this->FacesByLayers.clear();
  const pm::PolyMesh input = pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Boundary Refine",
                                            {pm::Stage::Resolved, pm::Stage::Projected});
  pm::BoundaryRefineReport report;
  const pm::PolyMesh result = pm::boundaryRefine(input, this->Options(), monitor, &report);
  this->WallFaces = report.wallFaces;
  this->FacesByLayers.assign(report.facesByLayers.begin(), report.facesByLayers.end());
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

void vtkBoundaryRefine::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Layers: " << this->Layers << "\n";
  os << indent << "ExpansionRatio: " << this->ExpansionRatio << "\n";
  os << indent << "FirstHeight: " << this->FirstHeight << "\n";
  os << indent << "WallFaces: " << this->WallFaces << "\n";
}
