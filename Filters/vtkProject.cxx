// SPDX-License-Identifier: BSD-3-Clause
#include "vtkProject.h"

#include "MeshPacking.h"
#include "Project.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace {

/// One row for each node that could not reach the geometry.
void listStuck(const std::vector<pm::StuckNode>& stuck, vtkFieldData* data) {
  vtkNew<vtkDoubleArray> position, distance;
  vtkNew<vtkStringArray> heldBy;
  position->SetName("StuckPosition");
  position->SetNumberOfComponents(3);
  distance->SetName("StuckDistance");
  heldBy->SetName("StuckBy");
  for (const pm::StuckNode& node : stuck) {
    position->InsertNextTuple(node.position.data());
    distance->InsertNextValue(node.distance);
    heldBy->InsertNextValue(node.heldBy);
  }
  data->AddArray(position);
  data->AddArray(distance);
  data->AddArray(heldBy);
}

}  // namespace

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
  DoneWith(inputs[0]);
  const auto model = this->Surface(inputs);
  pm::DistanceField field(*model, result.finestSize);
  std::vector<pm::StuckNode> stuck;
  pm::project(result, field, this->Options(), monitor, &stuck);
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
  listStuck(stuck, boundary->GetFieldData());
}

void vtkProject::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Rounds: " << this->Rounds << "\n";
}
