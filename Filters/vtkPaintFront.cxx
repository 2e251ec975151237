// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPaintFront.h"

#include "GeometryInput.h"
#include "MeshPacking.h"
#include "OctreePacking.h"
#include "PaintFront.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

struct vtkPaintFront::Lists {
  std::vector<pm::Vec3> points;
};

vtkStandardNewMacro(vtkPaintFront);

vtkPaintFront::vtkPaintFront() : vtkMeshStage(2, 1, 2), Repeated(std::make_unique<Lists>()) {
  const pm::PaintFrontOptions defaults;
  this->Region = static_cast<int>(defaults.region);
  this->AllowOpen = defaults.allowOpen;
  this->Fill = defaults.fill;
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

pm::PaintFrontOptions vtkPaintFront::Options() const {
  pm::PaintFrontOptions options;
  options.region = static_cast<pm::Region>(this->Region);
  options.points = this->Repeated->points;
  options.allowOpen = this->AllowOpen;
  options.fill = this->Fill;
  return options;
}

void vtkPaintFront::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                        pm::Monitor& monitor) {
  const pm::Octree tree = pm::unpackOctree(vtkUnstructuredGrid::GetData(inputs[0]), "Paint Front");
  const auto model = pm::surfaceFrom(vtkDataObject::GetData(inputs[1]), this->PatchArray);
  pm::PaintFrontReport report;
  const pm::PolyMesh front = pm::paintFront(tree, *model, this->Options(), monitor, &report);
  pm::packMesh(front, mesh);
  pm::packBoundary(front, boundary);
  pm::packRegions(report, mesh);
}

void vtkPaintFront::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Region: " << this->Region << "\n";
  os << indent << "SeedPoints: " << this->GetNumberOfSeedPoints() << "\n";
  os << indent << "AllowOpen: " << this->AllowOpen << "\n";
  os << indent << "Fill: " << this->Fill << "\n";
}
