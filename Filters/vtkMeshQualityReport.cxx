// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMeshQualityReport.h"

#include "MeshPacking.h"
#include "MeshQualityReport.h"
#include "QualityPacking.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkMeshQualityReport);

vtkMeshQualityReport::vtkMeshQualityReport() : vtkFoamLimitsStage(1, -1) {
  this->SetNumberOfOutputPorts(SUMMARY + 1);
  const pm::MeshQualityReportOptions defaults;
  this->MaximumNonOrthogonality = defaults.foam.maxNonOrthogonality;
  this->MinimumFaceTet = defaults.foam.minFaceTet;
  this->MinimumFlatness = defaults.foam.minFlatness;
  this->MaximumFaceConcavity = defaults.foam.maxFaceConcavity;
  this->MaximumAspectRatio = defaults.foam.maxAspectRatio;
  this->MaximumCellConcavity = defaults.foam.maxCellConcavity;
  this->WorstPlaces = defaults.worstPlaces;
  this->Bins = defaults.bins;
}

int vtkMeshQualityReport::FillOutputPortInformation(int port, vtkInformation* info) {
  if (port < WORST) return this->Superclass::FillOutputPortInformation(port, info);
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

pm::MeshQualityReportOptions vtkMeshQualityReport::Options() const {
  pm::MeshQualityReportOptions options;
  options.limits = this->Limits();
  options.foam.maxNonOrthogonality = this->MaximumNonOrthogonality;
  options.foam.minFaceTet = this->MinimumFaceTet;
  options.foam.minFlatness = this->MinimumFlatness;
  options.foam.maxFaceConcavity = this->MaximumFaceConcavity;
  options.foam.maxAspectRatio = this->MaximumAspectRatio;
  options.foam.maxCellConcavity = this->MaximumCellConcavity;
  if (this->EmptyDirection != NONE) options.solved[this->EmptyDirection - X] = false;
  options.worstPlaces = this->WorstPlaces;
  options.bins = this->Bins;
  return options;
}

void vtkMeshQualityReport::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* grid, vtkPolyData* faces,
                               pm::Monitor& monitor) {
  this->ConcaveCells = 0;
  const std::string name = "Mesh Quality Report";
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  const pm::PolyMesh mesh =
      pm::isPacked(input) ? pm::unpackMesh(input, name, {}) : pm::unpackCells(input, name);
  const pm::MeshQualityReport report = pm::reportMeshQuality(mesh, this->Options(), monitor);
  monitor.check(0.9, "storing measures");
  grid->ShallowCopy(input);
  pm::addQuality(report, mesh, grid);
  pm::packFacesOutside(report, mesh, faces);
  pm::packWorstPlaces(report, mesh, vtkTable::SafeDownCast(this->GetOutputDataObject(WORST)));
  pm::packHistograms(report, vtkTable::SafeDownCast(this->GetOutputDataObject(HISTOGRAMS)));
  pm::packQualitySummary(report, vtkTable::SafeDownCast(this->GetOutputDataObject(SUMMARY)));
  this->ConcaveCells = report.concaveCells;
}

void vtkMeshQualityReport::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaximumNonOrthogonality: " << this->MaximumNonOrthogonality << "\n";
  os << indent << "MinimumFaceTet: " << this->MinimumFaceTet << "\n";
  os << indent << "MinimumFlatness: " << this->MinimumFlatness << "\n";
  os << indent << "MaximumFaceConcavity: " << this->MaximumFaceConcavity << "\n";
  os << indent << "MaximumAspectRatio: " << this->MaximumAspectRatio << "\n";
  os << indent << "MaximumCellConcavity: " << this->MaximumCellConcavity << "\n";
  os << indent << "EmptyDirection: " << this->EmptyDirection << "\n";
  os << indent << "WorstPlaces: " << this->WorstPlaces << "\n";
  os << indent << "Bins: " << this->Bins << "\n";
  os << indent << "ConcaveCells: " << this->ConcaveCells << "\n";
}
