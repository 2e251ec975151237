// SPDX-License-Identifier: BSD-3-Clause
#include "vtkConvertCells.h"

#include "ConvertCells.h"
#include "MeshPacking.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkConvertCells);

vtkConvertCells::vtkConvertCells()
    : vtkMeshStage(1, -1, 2),
      CellShapes(static_cast<int>(pm::ConvertCellsOptions().shapes)),
      Report(std::make_unique<pm::ConvertCellsReport>()) {}

vtkConvertCells::~vtkConvertCells() = default;

void vtkConvertCells::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                          pm::Monitor& monitor) {
  *this->Report = pm::ConvertCellsReport();
  const pm::PolyMesh input = pm::unpackMesh(
      vtkUnstructuredGrid::GetData(inputs[0]), "Convert Cells",
      {pm::Stage::Refined, pm::Stage::Resolved, pm::Stage::Projected, pm::Stage::Layer, pm::Stage::Front});
  pm::ConvertCellsOptions options;
  options.shapes = static_cast<pm::CellShapes>(this->CellShapes);
  const pm::PolyMesh result = pm::convertCells(input, options, monitor, this->Report.get());
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

vtkIdType vtkConvertCells::GetTetrahedra() const { return this->Report->tetrahedra; }
vtkIdType vtkConvertCells::GetPyramids() const { return this->Report->pyramids; }
vtkIdType vtkConvertCells::GetWedges() const { return this->Report->wedges; }
vtkIdType vtkConvertCells::GetHexahedra() const { return this->Report->hexahedra; }
vtkIdType vtkConvertCells::GetCellsThatStay() const { return this->Report->cellsThatStay; }
vtkIdType vtkConvertCells::GetCellCentres() const { return this->Report->cellCentres; }
vtkIdType vtkConvertCells::GetFaceCentres() const { return this->Report->faceCentres; }
double vtkConvertCells::GetVolume() const { return this->Report->volume; }
double vtkConvertCells::GetVolumeChange() const { return this->Report->volumeChange; }
double vtkConvertCells::GetMaxSkewness() const { return this->Report->maxSkewness; }
double vtkConvertCells::GetMaxNonOrthogonality() const { return this->Report->maxNonOrthogonality; }
vtkIdType vtkConvertCells::GetNonOrthogonalFaces() const { return this->Report->nonOrthogonalFaces; }

void vtkConvertCells::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "CellShapes: " << this->CellShapes << "\n";
  os << indent << "Tetrahedra: " << this->GetTetrahedra() << "\n";
  os << indent << "Pyramids: " << this->GetPyramids() << "\n";
  os << indent << "Wedges: " << this->GetWedges() << "\n";
  os << indent << "Hexahedra: " << this->GetHexahedra() << "\n";
  os << indent << "CellsThatStay: " << this->GetCellsThatStay() << "\n";
}
