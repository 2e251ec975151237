// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFluentWriter.h"

#include "FluentWriter.h"
#include "MeshPacking.h"
#include "StageMonitor.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkFluentWriter);

vtkFluentWriter::~vtkFluentWriter() { this->SetFileName(nullptr); }

int vtkFluentWriter::FillInputPortInformation(int, vtkInformation* info) {
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  return 1;
}

void vtkFluentWriter::WriteData() {
  try {
    if (!this->FileName || !*this->FileName) {
      throw pm::InputError("No place to write to; set FileName (a .msh file).");
    }
    const pm::PolyMesh mesh = pm::unpackMesh(
        vtkUnstructuredGrid::SafeDownCast(this->GetInput()), "The Fluent writer",
        {pm::Stage::Refined, pm::Stage::Resolved, pm::Stage::Projected, pm::Stage::Layer, pm::Stage::Front});
    pm::StageMonitor monitor(this);
    pm::writeFluent(mesh, this->FileName, this->Binary, monitor);
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    this->SetErrorCode(vtkErrorCode::CannotOpenFileError);
  }
}

void vtkFluentWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Binary: " << this->Binary << "\n";
}
