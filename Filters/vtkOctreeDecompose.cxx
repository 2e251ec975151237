// SPDX-License-Identifier: BSD-3-Clause
#include "vtkOctreeDecompose.h"

#include "GeometryInput.h"
#include "OctreeDecompose.h"
#include "OctreePacking.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

struct vtkOctreeDecompose::Lists {
  std::vector<std::pair<std::string, double>> patchSizes;
  std::vector<pm::RefineBox> boxes;
};

vtkStandardNewMacro(vtkOctreeDecompose);

vtkOctreeDecompose::vtkOctreeDecompose() : vtkMeshStage(1, 0, 1), Repeated(std::make_unique<Lists>()) {
  const pm::OctreeDecomposeOptions defaults;
  this->FeatureSize = defaults.featureSize;
  this->MaximumLevel = defaults.maxLevel;
  this->BaseSize = defaults.baseSize;
  this->UseDomain = defaults.useDomain;
  this->Margin = defaults.margin;
  this->SurfaceSize = defaults.surfaceSize;
  this->NormalAngle = defaults.normalAngle;
  this->SharpAngle = defaults.sharpAngle;
  this->RefineEdges = defaults.refineEdges;
  this->Separate = defaults.separate;
  this->CloseAngle = defaults.closeAngle;
  this->BufferCells = defaults.bufferCells;
  this->CellsBetweenLevels = defaults.cellsBetweenLevels;
  this->MaximumCells = defaults.maxCells;
}

vtkOctreeDecompose::~vtkOctreeDecompose() = default;

void vtkOctreeDecompose::AddPatchSize(const char* patch, double size) {
  if (!patch || !*patch) return;  // an empty row of the property table
  this->Repeated->patchSizes.emplace_back(patch, size);
  this->Modified();
}

void vtkOctreeDecompose::ClearPatchSizes() {
  if (this->Repeated->patchSizes.empty()) return;
  this->Repeated->patchSizes.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfPatchSizes() const {
  return static_cast<int>(this->Repeated->patchSizes.size());
}

void vtkOctreeDecompose::AddRefineBox(double xmin, double xmax, double ymin, double ymax, double zmin,
                                      double zmax, double size) {
  pm::RefineBox refine;
  refine.box.lo = {xmin, ymin, zmin};
  refine.box.hi = {xmax, ymax, zmax};
  refine.size = size;
  this->Repeated->boxes.push_back(refine);
  this->Modified();
}

void vtkOctreeDecompose::ClearRefineBoxes() {
  if (this->Repeated->boxes.empty()) return;
  this->Repeated->boxes.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfRefineBoxes() const {
  return static_cast<int>(this->Repeated->boxes.size());
}

pm::OctreeDecomposeOptions vtkOctreeDecompose::Options() const {
  pm::OctreeDecomposeOptions options;
  options.featureSize = this->FeatureSize;
  options.maxLevel = this->MaximumLevel;
  options.baseSize = this->BaseSize;
  options.useDomain = this->UseDomain;
  const double* bounds = this->DomainBounds;
  options.domain.lo = {bounds[0], bounds[2], bounds[4]};
  options.domain.hi = {bounds[1], bounds[3], bounds[5]};
  options.margin = this->Margin;
  options.patchSizes = this->Repeated->patchSizes;
  options.surfaceSize = this->SurfaceSize;
  options.boxes = this->Repeated->boxes;
  options.normalAngle = this->NormalAngle;
  options.sharpAngle = this->SharpAngle;
  options.refineEdges = this->RefineEdges;
  options.separate = this->Separate;
  options.closeAngle = this->CloseAngle;
  options.bufferCells = this->BufferCells;
  options.cellsBetweenLevels = this->CellsBetweenLevels;
  options.maxCells = this->MaximumCells;
  return options;
}

void vtkOctreeDecompose::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData*,
                             pm::Monitor& monitor) {
  const auto model = pm::surfaceFrom(vtkDataObject::GetData(inputs[0]), this->PatchArray);
  pm::packOctree(pm::decompose(*model, this->Options(), monitor), mesh);
}

void vtkOctreeDecompose::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FeatureSize: " << this->FeatureSize << "\n";
  os << indent << "MaximumLevel: " << this->MaximumLevel << "\n";
  os << indent << "BaseSize: " << this->BaseSize << "\n";
  os << indent << "UseDomain: " << this->UseDomain << "\n";
  os << indent << "Margin: " << this->Margin << "\n";
  os << indent << "SurfaceSize: " << this->SurfaceSize << "\n";
  os << indent << "PatchSizes: " << this->GetNumberOfPatchSizes() << "\n";
  os << indent << "RefineBoxes: " << this->GetNumberOfRefineBoxes() << "\n";
  os << indent << "NormalAngle: " << this->NormalAngle << "\n";
  os << indent << "SharpAngle: " << this->SharpAngle << "\n";
  os << indent << "RefineEdges: " << this->RefineEdges << "\n";
  os << indent << "Separate: " << this->Separate << "\n";
  os << indent << "CloseAngle: " << this->CloseAngle << "\n";
  os << indent << "BufferCells: " << this->BufferCells << "\n";
  os << indent << "CellsBetweenLevels: " << this->CellsBetweenLevels << "\n";
  os << indent << "MaximumCells: " << this->MaximumCells << "\n";
}
