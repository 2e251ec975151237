// SPDX-License-Identifier: BSD-3-Clause
#include "vtkProjectionMesh.h"

#include <algorithm>

#include "FeaturePacking.h"
#include "LayerPacking.h"
#include "LeakPacking.h"
#include "MeshPacking.h"
#include "Pipeline.h"
#include "RegionPacking.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

struct vtkProjectionMesh::LastRun {
  pm::PipelineReport stages;
  std::vector<std::string> patchNames;
  std::vector<vtkIdType> patchFaces;
  std::vector<pm::Leak> leaks;  ///< why it failed
};

vtkStandardNewMacro(vtkProjectionMesh);

vtkProjectionMesh::vtkProjectionMesh() : vtkFoamLimitsStage(3, 0), Report(std::make_unique<LastRun>()) {
  const pm::PipelineOptions defaults;
  this->CloseHoles = static_cast<int>(defaults.closeHoles);
  this->StopAfter = static_cast<int>(defaults.stopAfter);
  this->SetNumberOfOutputPorts(LAYERS + 1);
}

vtkProjectionMesh::~vtkProjectionMesh() = default;

vtkMTimeType vtkProjectionMesh::GetMTime() {
  const std::initializer_list<vtkObject*> stages = {this->Octree,     this->Front,    this->Layer,
                                                    this->Projection, this->Features, this->Refine};
  vtkMTimeType time = this->Superclass::GetMTime();
  for (vtkObject* stage : stages) time = std::max(time, stage->GetMTime());
  return time;
}

void vtkProjectionMesh::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                            pm::Monitor& monitor) {
  *this->Report = LastRun();
  pm::PipelineOptions options;
  options.octree = this->Octree->Options(vtkDataObject::GetData(inputs[1]));
  options.front = this->Front->Options();
  options.layer = this->Layer->Options();
  options.project = this->Projection->Options();
  options.features = this->Features->Options(vtkDataObject::GetData(inputs[2]));
  options.refine = this->Refine->Options();
  options.layer.limits = options.project.limits = options.features.limits = options.refine.limits =
      this->Limits();
  options.closeHoles = static_cast<pm::HoleMethod>(this->CloseHoles);
  options.stopAfter = static_cast<pm::Stage>(this->StopAfter);

  const auto model = this->Surface(inputs);
  pm::PolyMesh result;
  try {
    result = pm::runPipeline(*model, options, monitor, &this->Report->stages);
  } catch (pm::LeakError& leak) {
    this->Report->leaks = std::move(leak.leaks);
    throw;
  }
  this->Report->patchNames = result.patchNames;
  this->Report->patchFaces.assign(result.patchNames.size(), 0);
  for (pm::Id patch : result.patch) ++this->Report->patchFaces[patch];
  pm::packMesh(result, mesh);
  pm::packRegions(this->Report->stages.front, mesh);
  pm::packBoundary(result, boundary);
  const pm::BoundaryRefineReport& layers = this->Report->stages.refine;
  pm::packLayers(layers, boundary);
  pm::packLayerTable(layers, vtkTable::SafeDownCast(this->GetOutputDataObject(LAYERS)));
  const pm::PaintFrontReport& front = this->Report->stages.front;
  pm::packRegionTable(front, result,
                      vtkTable::SafeDownCast(this->GetOutputDataObject(vtkPaintFront::REGIONS)));
  pm::packInvisible(front, result,
                    vtkPolyData::SafeDownCast(this->GetOutputDataObject(vtkPaintFront::INVISIBLE)));
  pm::packLeaks(front.leaked.leaks,
                vtkPolyData::SafeDownCast(this->GetOutputDataObject(vtkPaintFront::LEAKS)));
  pm::packUnresolved(this->Report->stages.features.unresolved,
                     vtkPolyData::SafeDownCast(this->GetOutputDataObject(UNRESOLVED)));
}

void vtkProjectionMesh::ShowFailure() {
  pm::packLeaks(this->Report->leaks,
                vtkPolyData::SafeDownCast(this->GetOutputDataObject(vtkPaintFront::LEAKS)));
}

int vtkProjectionMesh::FillOutputPortInformation(int port, vtkInformation* info) {
  if (port != vtkPaintFront::REGIONS && port != LAYERS)
    return this->Superclass::FillOutputPortInformation(port, info);
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

int vtkProjectionMesh::FillInputPortInformation(int port, vtkInformation* info) {
  if (port == 1 || port == 2) return DescribeOptionalPort(info);
  return this->Superclass::FillInputPortInformation(port, info);
}

int vtkProjectionMesh::GetNumberOfPatches() const {
  return static_cast<int>(this->Report->patchNames.size());
}

const char* vtkProjectionMesh::GetPatchName(int patch) const {
  const bool known = patch >= 0 && patch < this->GetNumberOfPatches();
  return known ? this->Report->patchNames[patch].c_str() : nullptr;
}

vtkIdType vtkProjectionMesh::GetPatchFaces(int patch) const {
  const bool known = patch >= 0 && patch < this->GetNumberOfPatches();
  return known ? this->Report->patchFaces[patch] : 0;
}

double vtkProjectionMesh::GetFeatureLength() const { return this->Report->stages.features.featureLength; }
double vtkProjectionMesh::GetResolvedLength() const { return this->Report->stages.features.resolvedLength; }
vtkIdType vtkProjectionMesh::GetCorners() const { return this->Report->stages.features.corners; }
vtkIdType vtkProjectionMesh::GetResolvedCorners() const {
  return this->Report->stages.features.resolvedCorners;
}
vtkIdType vtkProjectionMesh::GetWallFaces() const { return this->Report->stages.refine.wallFaces; }

vtkIdType vtkProjectionMesh::GetFacesWithLayers(int layers) const {
  const std::vector<pm::Id>& faces = this->Report->stages.refine.facesByLayers;
  return layers >= 1 && layers <= static_cast<int>(faces.size()) ? faces[layers - 1] : 0;
}

void vtkProjectionMesh::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "CloseHoles: " << this->CloseHoles << "\n";
  os << indent << "StopAfter: " << this->StopAfter << "\n";
  for (vtkObject* stage : std::initializer_list<vtkObject*>{this->Octree, this->Front, this->Layer,
                                                            this->Projection, this->Features, this->Refine}) {
    os << indent << stage->GetClassName() << ":\n";
    stage->PrintSelf(os, indent.GetNextIndent());
  }
}
