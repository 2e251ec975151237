// SPDX-License-Identifier: BSD-3-Clause
#include "vtkCloseHoles.h"

#include "CloseHoles.h"
#include "LeakPacking.h"
#include "Monitor.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

struct vtkCloseHoles::GivenPoints {
  std::vector<pm::Vec3> inside, outside;
};

vtkStandardNewMacro(vtkCloseHoles);

vtkCloseHoles::vtkCloseHoles() : Given(std::make_unique<GivenPoints>()) {
  const pm::CloseHolesOptions defaults;
  this->Method = static_cast<int>(defaults.method);
  this->MaximumWidth = defaults.maximumWidth;
  this->Roominess = defaults.search.roominess;
  this->SmallestRoom = defaults.search.smallestRoom;
  this->SetNumberOfOutputPorts(4);
}

vtkCloseHoles::~vtkCloseHoles() = default;

int vtkCloseHoles::FillOutputPortInformation(int port, vtkInformation* info) {
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 3 ? "vtkTable" : "vtkPolyData");
  return 1;
}

void vtkCloseHoles::AddInsidePoint(double x, double y, double z) {
  this->Given->inside.emplace_back(x, y, z);
  this->Modified();
}

void vtkCloseHoles::ClearInsidePoints() {
  if (this->Given->inside.empty()) return;
  this->Given->inside.clear();
  this->Modified();
}

int vtkCloseHoles::GetNumberOfInsidePoints() const { return static_cast<int>(this->Given->inside.size()); }

void vtkCloseHoles::AddOutsidePoint(double x, double y, double z) {
  this->Given->outside.emplace_back(x, y, z);
  this->Modified();
}

void vtkCloseHoles::ClearOutsidePoints() {
  if (this->Given->outside.empty()) return;
  this->Given->outside.clear();
  this->Modified();
}

int vtkCloseHoles::GetNumberOfOutsidePoints() const { return static_cast<int>(this->Given->outside.size()); }

pm::CloseHolesOptions vtkCloseHoles::HoleOptions() const {
  pm::CloseHolesOptions options;
  options.method = static_cast<pm::HoleMethod>(this->Method);
  options.maximumWidth = this->MaximumWidth;
  options.search.insidePoints = this->Given->inside;
  options.search.outsidePoints = this->Given->outside;
  options.search.roominess = this->Roominess;
  options.search.smallestRoom = this->SmallestRoom;
  return options;
}

void vtkCloseHoles::Run(vtkInformationVector** inputs, vtkUnstructuredGrid*, vtkPolyData* paths,
                        pm::Monitor& monitor) {
  const auto model = this->Surface(inputs);
  pm::CloseHolesReport report;
  const auto closed = pm::closeHoles(*model, this->Options(vtkDataObject::GetData(inputs[1])),
                                     this->HoleOptions(), monitor, &report);
  std::vector<pm::Leak> leaks;
  for (const pm::Hole& hole : report.holes) leaks.push_back(hole.leak);
  pm::packSurface(*closed, vtkPolyData::SafeDownCast(this->GetOutputDataObject(0)));
  pm::packLeaks(leaks, paths);
  pm::packMembranes(report.holes, vtkPolyData::SafeDownCast(this->GetOutputDataObject(2)));
  pm::packHoleTable(report.holes, vtkTable::SafeDownCast(this->GetOutputDataObject(3)));
}

void vtkCloseHoles::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << this->Method << "\n";
  os << indent << "MaximumWidth: " << this->MaximumWidth << "\n";
  os << indent << "InsidePoints: " << this->GetNumberOfInsidePoints() << "\n";
  os << indent << "OutsidePoints: " << this->GetNumberOfOutsidePoints() << "\n";
  os << indent << "Roominess: " << this->Roominess << "\n";
  os << indent << "SmallestRoom: " << this->SmallestRoom << "\n";
}
