// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFarField.h"

#include "FarField.h"
#include "MeshPacking.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkFarField);

vtkFarField::vtkFarField() : vtkValidMeshStage(1, -1), Report(std::make_unique<pm::FarFieldReport>()) {
  const pm::FarFieldOptions defaults;
  this->Shape = static_cast<int>(defaults.shape);
  this->ExtendXmin = defaults.extend[0];
  this->ExtendXmax = defaults.extend[1];
  this->ExtendYmin = defaults.extend[2];
  this->ExtendYmax = defaults.extend[3];
  this->ExtendZmin = defaults.extend[4];
  this->ExtendZmax = defaults.extend[5];
  this->Distance = defaults.distance;
  this->UseBounds = defaults.useBounds;
  this->Radius = defaults.radius;
  this->ExpansionRatio = defaults.expansionRatio;
  this->MaximumLayers = defaults.maxLayers;
}

vtkFarField::~vtkFarField() = default;

pm::FarFieldOptions vtkFarField::Options() const {
  pm::FarFieldOptions options;
  options.shape = static_cast<pm::FarShape>(this->Shape);
  options.extend = {this->ExtendXmin, this->ExtendXmax, this->ExtendYmin,
                    this->ExtendYmax, this->ExtendZmin, this->ExtendZmax};
  options.distance = this->Distance;
  options.useBounds = this->UseBounds;
  const double* bounds = this->FarBounds;
  options.bounds.lo = {bounds[0], bounds[2], bounds[4]};
  options.bounds.hi = {bounds[1], bounds[3], bounds[5]};
  options.radius = this->Radius;
  options.expansionRatio = this->ExpansionRatio;
  options.maxLayers = this->MaximumLayers;
  options.limits = this->Limits();
  return options;
}

void vtkFarField::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                      pm::Monitor& monitor) {
  *this->Report = pm::FarFieldReport();
  const pm::PolyMesh inner = pm::unpackMesh(
      vtkUnstructuredGrid::GetData(inputs[0]), "Far Field",
      {pm::Stage::Refined, pm::Stage::Resolved, pm::Stage::Projected, pm::Stage::Layer, pm::Stage::Front});
  DoneWith(inputs[0]);
  const pm::PolyMesh result = pm::farField(inner, this->Options(), monitor, this->Report.get());
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

vtkIdType vtkFarField::GetFarCells() const { return this->Report->cells; }
double vtkFarField::GetFarVolume() const { return this->Report->volume; }
int vtkFarField::GetFarLayers() const { return this->Report->layers; }

void vtkFarField::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Shape: " << this->Shape << "\n";
  os << indent << "Extend: " << this->ExtendXmin << this->ExtendXmax << this->ExtendYmin << this->ExtendYmax
     << this->ExtendZmin << this->ExtendZmax << "\n";
  os << indent << "Distance: " << this->Distance << "\n";
  os << indent << "UseBounds: " << this->UseBounds << "\n";
  os << indent << "Radius: " << this->Radius << "\n";
  os << indent << "ExpansionRatio: " << this->ExpansionRatio << "\n";
  os << indent << "MaximumLayers: " << this->MaximumLayers << "\n";
  os << indent << "FarCells: " << this->GetFarCells() << "\n";
}
