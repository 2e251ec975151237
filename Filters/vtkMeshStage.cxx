// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMeshStage.h"

#include <tbb/global_control.h>

#include <memory>
#include <new>

#include "GeometryInput.h"
#include "StageMonitor.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkMeshStage::vtkMeshStage(int inputPorts, int geometryPort, int outputPorts) : GeometryPort(geometryPort) {
  this->SetNumberOfInputPorts(inputPorts);
  this->SetNumberOfOutputPorts(outputPorts);
}

vtkMeshStage::~vtkMeshStage() { this->SetPatchArray(nullptr); }

namespace {

void takePolyData(vtkInformation* info) {
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
}

}  // namespace

int vtkMeshStage::DescribeOptionalPort(vtkInformation* info) {
  takePolyData(info);
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkMeshStage::FillInputPortInformation(int port, vtkInformation* info) {
  if (port == this->GeometryPort) {
    takePolyData(info);
  } else {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  }
  return 1;
}

int vtkMeshStage::FillOutputPortInformation(int port, vtkInformation* info) {
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  return 1;
}

int vtkMeshStage::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(outputs, 0);
  vtkPolyData* boundary = this->GetNumberOfOutputPorts() > 1 ? vtkPolyData::GetData(outputs, 1) : nullptr;
  std::unique_ptr<tbb::global_control> limit;
  if (this->Threads > 0) {
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(this->Threads));
  }
  if (this->RunSafely(inputs, mesh, boundary)) {
    this->UpdateProgress(1.0);
    return 1;
  }
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
    vtkDataObject::GetData(outputs, port)->Initialize();
  this->ShowFailure();
  return 0;
}

bool vtkMeshStage::RunSafely(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh,
                             vtkPolyData* boundary) {
  pm::StageMonitor monitor(this);
  try {
    this->Run(inputs, mesh, boundary, monitor);
    return true;
  } catch (const pm::AbortError& stopped) {
    vtkWarningMacro(<< stopped.what());
  } catch (const pm::Error& error) {
    vtkErrorMacro(<< error.what());
  } catch (const std::bad_alloc&) {
    vtkErrorMacro(<< "There is not enough memory for this mesh; use larger cells or a smaller domain.");
  } catch (const std::exception& error) {
    vtkErrorMacro(<< "This is a fault of the program, please report it: " << error.what());
  }
  return false;
}

std::shared_ptr<const pm::SurfaceModel> vtkMeshStage::Surface(vtkInformationVector** inputs) {
  this->Held = pm::surfaceFrom(vtkDataObject::GetData(inputs[this->GeometryPort]), this->PatchArray);
  return this->Held;
}

void vtkMeshStage::DoneWith(vtkInformationVector* input) {
  const bool wanted = input->GetInformationObject(0)->Get(vtkDemandDrivenPipeline::RELEASE_DATA()) == 0;
  if (!wanted) vtkDataObject::GetData(input)->ReleaseData();
}

void vtkMeshStage::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Threads: " << this->Threads << "\n";
  os << indent << "PatchArray: " << (this->PatchArray ? this->PatchArray : "(automatic)") << "\n";
}
