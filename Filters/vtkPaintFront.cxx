// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPaintFront.h"

#include "LeakPacking.h"
#include "LeakPaths.h"
#include "MeshPacking.h"
#include "OctreePacking.h"
#include "PaintFront.h"
#include "RegionPacking.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

struct vtkPaintFront::Lists {
  std::vector<pm::Vec3> points, keepOut;
  std::vector<pm::Id> ids;
  std::vector<std::string> patches;
  std::vector<pm::Leak> leaks;  ///< why the last run failed
};

vtkStandardNewMacro(vtkPaintFront);

vtkPaintFront::vtkPaintFront() : vtkMeshStage(2, 1, 5), Repeated(std::make_unique<Lists>()) {
  const pm::PaintFrontOptions defaults;
  this->Region = static_cast<int>(defaults.region);
  this->AllowOpen = defaults.allowOpen;
  this->Fill = defaults.fill;
  this->ReportInvisible = defaults.reportInvisible;
  this->ReportLeaks = defaults.reportLeaks;
}

vtkPaintFront::~vtkPaintFront() = default;

void vtkPaintFront::AddSeedPoint(double x, double y, double z) {
  this->Repeated->points.emplace_back(x, y, z);
  this->Modified();
}

void vtkPaintFront::ClearSeedPoints() {
  if (this->Repeated->points.empty()) return;
  this->Repeated->points.clear();
  this->Modified();
}

int vtkPaintFront::GetNumberOfSeedPoints() const { return static_cast<int>(this->Repeated->points.size()); }

void vtkPaintFront::AddKeepOutPoint(double x, double y, double z) {
  this->Repeated->keepOut.emplace_back(x, y, z);
  this->Modified();
}

void vtkPaintFront::ClearKeepOutPoints() {
  if (this->Repeated->keepOut.empty()) return;
  this->Repeated->keepOut.clear();
  this->Modified();
}

int vtkPaintFront::GetNumberOfKeepOutPoints() const {
  return static_cast<int>(this->Repeated->keepOut.size());
}

void vtkPaintFront::AddRegionId(int id) {
  this->Repeated->ids.push_back(id);
  this->Modified();
}

void vtkPaintFront::ClearRegionIds() {
  if (this->Repeated->ids.empty()) return;
  this->Repeated->ids.clear();
  this->Modified();
}

int vtkPaintFront::GetNumberOfRegionIds() const { return static_cast<int>(this->Repeated->ids.size()); }

void vtkPaintFront::AddRegionPatch(const char* name) {
  if (!name || !*name) return;
  this->Repeated->patches.emplace_back(name);
  this->Modified();
}

void vtkPaintFront::ClearRegionPatches() {
  if (this->Repeated->patches.empty()) return;
  this->Repeated->patches.clear();
  this->Modified();
}

int vtkPaintFront::GetNumberOfRegionPatches() const {
  return static_cast<int>(this->Repeated->patches.size());
}

int vtkPaintFront::FillOutputPortInformation(int port, vtkInformation* info) {
  if (port != REGIONS) return this->Superclass::FillOutputPortInformation(port, info);
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

pm::PaintFrontOptions vtkPaintFront::Options() const {
  pm::PaintFrontOptions options;
  options.region = static_cast<pm::Region>(this->Region);
  options.points = this->Repeated->points;
  options.keepOut = this->Repeated->keepOut;
  options.ids = this->Repeated->ids;
  options.patches = this->Repeated->patches;
  options.allowOpen = this->AllowOpen;
  options.fill = this->Fill;
  options.reportInvisible = this->ReportInvisible;
  options.reportLeaks = this->ReportLeaks;
  return options;
}

void vtkPaintFront::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                        pm::Monitor& monitor) {
  pm::Octree tree = pm::unpackOctree(vtkUnstructuredGrid::GetData(inputs[0]), "Paint Front");
  DoneWith(inputs[0]);
  const auto model = this->Surface(inputs);
  pm::listTriangles(tree, *model);
  pm::PaintFrontReport report;
  pm::PolyMesh front;
  this->Repeated->leaks.clear();
  try {
    front = pm::paintFront(tree, *model, this->Options(), monitor, &report);
  } catch (pm::LeakError& leak) {
    this->Repeated->leaks = std::move(leak.leaks);
    throw;
  }
  pm::packMesh(front, mesh);
  pm::packBoundary(front, boundary);
  pm::packRegions(report, mesh);
  pm::packRegionTable(report, front, vtkTable::SafeDownCast(this->GetOutputDataObject(REGIONS)));
  pm::packInvisible(report, front, vtkPolyData::SafeDownCast(this->GetOutputDataObject(INVISIBLE)));
  pm::packLeaks(report.leaked.leaks, vtkPolyData::SafeDownCast(this->GetOutputDataObject(LEAKS)));
}

void vtkPaintFront::ShowFailure() {
  pm::packLeaks(this->Repeated->leaks, vtkPolyData::SafeDownCast(this->GetOutputDataObject(LEAKS)));
}

void vtkPaintFront::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Region: " << this->Region << "\n";
  os << indent << "SeedPoints: " << this->GetNumberOfSeedPoints() << "\n";
  os << indent << "KeepOutPoints: " << this->GetNumberOfKeepOutPoints() << "\n";
  os << indent << "RegionIds: " << this->GetNumberOfRegionIds() << "\n";
  os << indent << "RegionPatches: " << this->GetNumberOfRegionPatches() << "\n";
  os << indent << "AllowOpen: " << this->AllowOpen << "\n";
  os << indent << "Fill: " << this->Fill << "\n";
  os << indent << "ReportInvisible: " << this->ReportInvisible << "\n";
  os << indent << "ReportLeaks: " << this->ReportLeaks << "\n";
}
