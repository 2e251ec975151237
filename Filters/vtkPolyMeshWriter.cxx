// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPolyMeshWriter.h"

#include <filesystem>
#include <fstream>

#include "FoamWriter.h"
#include "MeshPacking.h"
#include "StageMonitor.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

namespace fs = std::filesystem;

vtkStandardNewMacro(vtkPolyMeshWriter);

vtkPolyMeshWriter::~vtkPolyMeshWriter() {
  this->SetFileName(nullptr);
  this->SetDirectory(nullptr);
}

int vtkPolyMeshWriter::FillInputPortInformation(int, vtkInformation* info) {
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  return 1;
}

void vtkPolyMeshWriter::WriteData() {
  try {
    const bool intoCase = !this->Directory || !*this->Directory;
    if (intoCase && (!this->FileName || !*this->FileName)) {
      throw pm::InputError(
          "No place to write to; set FileName (a .foam file) or Directory (a polyMesh folder).");
    }
    const pm::PolyMesh mesh = pm::unpackMesh(
        vtkUnstructuredGrid::SafeDownCast(this->GetInput()), "The polyMesh writer",
        {pm::Stage::Refined, pm::Stage::Resolved, pm::Stage::Projected, pm::Stage::Layer, pm::Stage::Front});
    const fs::path folder = intoCase ? fs::absolute(this->FileName).parent_path() / "constant" / "polyMesh"
                                     : fs::path(this->Directory);
    pm::StageMonitor monitor(this);
    pm::writePolyMesh(mesh, folder.string(), this->Binary, monitor);
    if (intoCase && !std::ofstream(this->FileName)) {
      throw pm::InputError(std::string("The file ") + this->FileName + " cannot be written.");
    }
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    this->SetErrorCode(vtkErrorCode::CannotOpenFileError);
  }
}

void vtkPolyMeshWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Directory: " << (this->Directory ? this->Directory : "(none)") << "\n";
  os << indent << "Binary: " << this->Binary << "\n";
}
