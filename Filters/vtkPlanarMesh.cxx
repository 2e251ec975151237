// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPlanarMesh.h"

#include "MeshPacking.h"
#include "PlanarMesh.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPlanarMesh);

vtkPlanarMesh::vtkPlanarMesh() : vtkMeshStage(1, -1, 2), Report(std::make_unique<pm::PlanarMeshReport>()) {
  const pm::PlanarMeshOptions defaults;
  this->Axis = defaults.axis;
  this->Position = defaults.position;
  this->Thickness = defaults.thickness;
}

vtkPlanarMesh::~vtkPlanarMesh() = default;

void vtkPlanarMesh::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                        pm::Monitor& monitor) {
  *this->Report = pm::PlanarMeshReport();
  const pm::PolyMesh input = pm::unpackMesh(
      vtkUnstructuredGrid::GetData(inputs[0]), "Planar Mesh",
      {pm::Stage::Refined, pm::Stage::Resolved, pm::Stage::Projected, pm::Stage::Layer, pm::Stage::Front});
  pm::PlanarMeshOptions options;
  options.axis = this->Axis;
  options.position = this->Position;
  options.thickness = this->Thickness;
  const pm::PolyMesh result = pm::planarMesh(input, options, monitor, this->Report.get());
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

double vtkPlanarMesh::GetArea() const { return this->Report->area; }
vtkIdType vtkPlanarMesh::GetDrawnTogether() const { return this->Report->drawnTogether; }

void vtkPlanarMesh::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Axis: " << this->Axis << "\n";
  os << indent << "Position: " << this->Position << "\n";
  os << indent << "Thickness: " << this->Thickness << "\n";
  os << indent << "Area: " << this->GetArea() << "\n";
  os << indent << "DrawnTogether: " << this->GetDrawnTogether() << "\n";
}
