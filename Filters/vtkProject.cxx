// SPDX-License-Identifier: BSD-3-Clause
#include "vtkProject.h"

#include "MeshPacking.h"
#include "Project.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkProject);

vtkProject::vtkProject() : vtkFoamLimitsStage(2, 1) {
  const pm::ProjectOptions defaults;
  this->Rounds = defaults.rounds;
}

pm::ProjectOptions vtkProject::Options() const {
  pm::ProjectOptions options;
  options.rounds = this->Rounds;
  options.limits = this->Limits();
  return options;
}

void vtkProject::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                     pm::Monitor& monitor) {
  pm::PolyMesh result =
      pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Project", {pm::Stage::Layer});
  const auto model = this->Surface(inputs);
  pm::DistanceField field(*model, result.finestSize);
  pm::project(result, field, this->Options(), monitor);
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

void vtkProject::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Rounds: " << this->Rounds << "\n";
}
