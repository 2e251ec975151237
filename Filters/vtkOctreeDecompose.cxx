// SPDX-License-Identifier: BSD-3-Clause
#include "vtkOctreeDecompose.h"

#include "GeometryInput.h"
#include "OctreeDecompose.h"
#include "OctreePacking.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

struct vtkOctreeDecompose::Lists {
  std::vector<std::pair<std::string, double>> patchSizes;
  std::vector<pm::RefineBox> boxes;
  std::vector<pm::RefineSphere> spheres;
  std::vector<pm::RefineCylinder> cylinders;
  std::vector<pm::PatchDistance> patchDistances;
  std::vector<pm::SurfaceDistance> surfaceDistances;
};

vtkStandardNewMacro(vtkOctreeDecompose);

vtkOctreeDecompose::vtkOctreeDecompose() : vtkMeshStage(2, 0, 1), Repeated(std::make_unique<Lists>()) {
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
  this->CellNormals = defaults.cellNormals;
  this->NeighbourNormals = defaults.neighbourNormals;
  this->CellSeparation = defaults.cellSeparation;
  this->NeighbourSeparation = defaults.neighbourSeparation;
  this->RefineSharp = defaults.refineSharp;
  this->RefineInterfaces = defaults.refineInterfaces;
  this->RefineOpen = static_cast<int>(defaults.refineOpen);
  this->RefineCorners = defaults.refineCorners;
  this->FeatureDepth = static_cast<int>(defaults.featureDepth);
  this->FeatureBuffer = defaults.featureBuffer;
  this->GapCells = defaults.gapCells;
  this->CellsPerCircle = defaults.cellsPerCircle;
  this->MaximumMemory = defaults.maxMemory;
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

void vtkOctreeDecompose::AddRefineSphere(double x, double y, double z, double radius, double size) {
  this->Repeated->spheres.push_back({{x, y, z}, radius, size});
  this->Modified();
}

void vtkOctreeDecompose::ClearRefineSpheres() {
  if (this->Repeated->spheres.empty()) return;
  this->Repeated->spheres.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfRefineSpheres() const {
  return static_cast<int>(this->Repeated->spheres.size());
}

void vtkOctreeDecompose::AddRefineCylinder(double x0, double y0, double z0, double x1, double y1, double z1,
                                           double radius, double size) {
  this->Repeated->cylinders.push_back({{x0, y0, z0}, {x1, y1, z1}, radius, size});
  this->Modified();
}

void vtkOctreeDecompose::ClearRefineCylinders() {
  if (this->Repeated->cylinders.empty()) return;
  this->Repeated->cylinders.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfRefineCylinders() const {
  return static_cast<int>(this->Repeated->cylinders.size());
}

void vtkOctreeDecompose::AddPatchDistance(const char* patch, double distance, double size) {
  if (!patch || !*patch) return;  // an empty row of the property table
  this->Repeated->patchDistances.push_back({patch, distance, size});
  this->Modified();
}

void vtkOctreeDecompose::ClearPatchDistances() {
  if (this->Repeated->patchDistances.empty()) return;
  this->Repeated->patchDistances.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfPatchDistances() const {
  return static_cast<int>(this->Repeated->patchDistances.size());
}

void vtkOctreeDecompose::AddSurfaceDistance(double distance, double size) {
  this->Repeated->surfaceDistances.push_back({distance, size});
  this->Modified();
}

void vtkOctreeDecompose::ClearSurfaceDistances() {
  if (this->Repeated->surfaceDistances.empty()) return;
  this->Repeated->surfaceDistances.clear();
  this->Modified();
}

int vtkOctreeDecompose::GetNumberOfSurfaceDistances() const {
  return static_cast<int>(this->Repeated->surfaceDistances.size());
}

int vtkOctreeDecompose::FillInputPortInformation(int port, vtkInformation* info) {
  return port == 1 ? DescribeOptionalPort(info) : this->Superclass::FillInputPortInformation(port, info);
}

pm::OctreeDecomposeOptions vtkOctreeDecompose::Options(vtkDataObject* sizeSurface) const {
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
  options.spheres = this->Repeated->spheres;
  options.cylinders = this->Repeated->cylinders;
  options.patchDistances = this->Repeated->patchDistances;
  options.surfaceDistances = this->Repeated->surfaceDistances;
  options.normalAngle = this->NormalAngle;
  options.sharpAngle = this->SharpAngle;
  options.refineEdges = this->RefineEdges;
  options.separate = this->Separate;
  options.closeAngle = this->CloseAngle;
  options.bufferCells = this->BufferCells;
  options.cellsBetweenLevels = this->CellsBetweenLevels;
  options.maxCells = this->MaximumCells;
  options.cellNormals = this->CellNormals;
  options.neighbourNormals = this->NeighbourNormals;
  options.cellSeparation = this->CellSeparation;
  options.neighbourSeparation = this->NeighbourSeparation;
  options.refineSharp = this->RefineSharp;
  options.refineInterfaces = this->RefineInterfaces;
  options.refineOpen = static_cast<pm::OpenEdgeRefinement>(this->RefineOpen);
  options.refineCorners = this->RefineCorners;
  options.featureDepth = static_cast<pm::FeatureDepth>(this->FeatureDepth);
  options.featureBuffer = this->FeatureBuffer;
  options.gapCells = this->GapCells;
  options.cellsPerCircle = this->CellsPerCircle;
  options.maxMemory = this->MaximumMemory;
  if (sizeSurface) options.sizeSurface = pm::surfaceFrom(sizeSurface, nullptr);
  return options;
}

void vtkOctreeDecompose::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData*,
                             pm::Monitor& monitor) {
  const auto model = this->Surface(inputs);
  pm::packOctree(pm::decompose(*model, this->Options(vtkDataObject::GetData(inputs[1])), monitor), mesh);
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
  os << indent << "RefineSpheres: " << this->GetNumberOfRefineSpheres() << "\n";
  os << indent << "RefineCylinders: " << this->GetNumberOfRefineCylinders() << "\n";
  os << indent << "PatchDistances: " << this->GetNumberOfPatchDistances() << "\n";
  os << indent << "SurfaceDistances: " << this->GetNumberOfSurfaceDistances() << "\n";
  os << indent << "CellNormals: " << this->CellNormals << "\n";
  os << indent << "NeighbourNormals: " << this->NeighbourNormals << "\n";
  os << indent << "CellSeparation: " << this->CellSeparation << "\n";
  os << indent << "NeighbourSeparation: " << this->NeighbourSeparation << "\n";
  os << indent << "RefineSharp: " << this->RefineSharp << "\n";
  os << indent << "RefineInterfaces: " << this->RefineInterfaces << "\n";
  os << indent << "RefineOpen: " << this->RefineOpen << "\n";
  os << indent << "RefineCorners: " << this->RefineCorners << "\n";
  os << indent << "FeatureDepth: " << this->FeatureDepth << "\n";
  os << indent << "FeatureBuffer: " << this->FeatureBuffer << "\n";
  os << indent << "GapCells: " << this->GapCells << "\n";
  os << indent << "CellsPerCircle: " << this->CellsPerCircle << "\n";
  os << indent << "MaximumMemory: " << this->MaximumMemory << "\n";
}
