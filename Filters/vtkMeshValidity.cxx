// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMeshValidity.h"

#include <utility>
#include <vector>

#include "MeshPacking.h"
#include "MeshQuality.h"
#include "vtkCellData.h"
#include "vtkFloatArray.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

struct vtkMeshValidity::Findings {
  pm::QualitySummary summary;
  std::string description;
  vtkIdType internalFaces = 0, boundaryFaces = 0;
};

vtkStandardNewMacro(vtkMeshValidity);

vtkMeshValidity::vtkMeshValidity() : vtkValidMeshStage(1, -1), Found(std::make_unique<Findings>()) {}
vtkMeshValidity::~vtkMeshValidity() = default;

namespace {

/// A cell array of `count` values, `start` to begin with.
float* addCellArray(vtkUnstructuredGrid* grid, const char* name, pm::Id count, float start) {
  vtkNew<vtkFloatArray> array;
  array->SetName(name);
  array->SetNumberOfValues(count);
  array->FillValue(start);
  grid->GetCellData()->AddArray(array);
  return array->GetPointer(0);
}

/// For each cell the worst value of its faces; worse(a, b): a is worse than b.
template <class Value, class Worse>
void addWorstOfFaces(const pm::PolyMesh& mesh, vtkUnstructuredGrid* grid, const char* name, float best,
                     const Value& value, const Worse& worse) {
  float* result = addCellArray(grid, name, mesh.cellCount, best);
  for (pm::Id f = 0; f < mesh.faceCount(); ++f) {
    const float v = static_cast<float>(value(f));
    const auto take = [&](pm::Id cell) {
      if (worse(v, result[cell])) result[cell] = v;
    };
    take(mesh.owner[f]);
    if (f < mesh.internalFaces()) take(mesh.neighbour[f]);
  }
}

/// Frees the measures of cells, which need more room than all these arrays, once they are stored.
void addMeasures(const pm::PolyMesh& mesh, pm::MeshMeasures m, vtkUnstructuredGrid* grid) {
  const double unit = mesh.finestSize > 0 ? mesh.finestSize * mesh.finestSize * mesh.finestSize : 1.0;
  float* volume = addCellArray(grid, "CellVolume", mesh.cellCount, 0);
  float* tet = addCellArray(grid, "SmallestTet", mesh.cellCount, 0);
  for (pm::Id c = 0; c < mesh.cellCount; ++c) {
    volume[c] = static_cast<float>(m.cells[c].volume / unit);
    tet[c] = static_cast<float>(m.cells[c].minTet / unit);
  }
  m.cells = std::vector<pm::CellMeasures>();
  const auto larger = [](float a, float b) { return a > b; };
  const auto smaller = [](float a, float b) { return a < b; };
  const auto add = [&](const char* name, float best, const auto& value, const auto& worse) {
    addWorstOfFaces(mesh, grid, name, best, value, worse);
  };
  add(
      "Degradation", 1, [&](pm::Id f) { return m.faces[f].eta; }, smaller);
  add(
      "Angle", 0, [&](pm::Id f) { return m.faceAngle[f]; }, larger);
  add(
      "Warpage", 0, [&](pm::Id f) { return m.faces[f].warpage(); }, larger);
  add(
      "Skewness", 0, [&](pm::Id f) { return m.faceSkew[f]; }, larger);
}

}  // namespace

void vtkMeshValidity::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* grid, vtkPolyData* boundary,
                          pm::Monitor& monitor) {
  *this->Found = Findings();
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  const pm::PolyMesh mesh = pm::unpackMesh(input, "Mesh Validity", {});
  this->Found->internalFaces = mesh.internalFaces();
  this->Found->boundaryFaces = mesh.boundaryFaces();
  this->Found->description = pm::checkTopology(mesh);
  monitor.check(0.3, "measuring");
  grid->ShallowCopy(input);
  this->Measure(mesh, grid);
  monitor.check(0.9, "storing the boundary");
  pm::packBoundary(mesh, boundary);
}

void vtkMeshValidity::Measure(const pm::PolyMesh& mesh, vtkUnstructuredGrid* grid) {
  pm::MeshMeasures measures = pm::measure(mesh);
  pm::QualityLimits limits = this->Limits();
  if (mesh.stage == pm::Stage::Refined) limits.minVolume = limits.minEtaInternal = limits.minEtaBoundary = 0;
  this->Found->summary = pm::summarise(mesh, measures, limits);
  this->Found->description += pm::describeViolations(mesh, measures, limits);
  if (this->Found->summary.violations == 0 && !this->Found->description.empty())
    this->Found->summary.violations = 1;
  addMeasures(mesh, std::move(measures), grid);
}

vtkIdType vtkMeshValidity::GetViolations() const { return this->Found->summary.violations; }
const char* vtkMeshValidity::GetDescription() const { return this->Found->description.c_str(); }
vtkIdType vtkMeshValidity::GetInternalFaces() const { return this->Found->internalFaces; }
vtkIdType vtkMeshValidity::GetBoundaryFaces() const { return this->Found->boundaryFaces; }
double vtkMeshValidity::GetTotalVolume() const { return this->Found->summary.totalVolume; }
double vtkMeshValidity::GetWorstVolume() const { return this->Found->summary.minVolume; }
double vtkMeshValidity::GetWorstTet() const { return this->Found->summary.minTet; }
double vtkMeshValidity::GetWorstEtaInternal() const { return this->Found->summary.minEtaInternal; }
double vtkMeshValidity::GetWorstEtaBoundary() const { return this->Found->summary.minEtaBoundary; }
double vtkMeshValidity::GetWorstAngleInternal() const { return this->Found->summary.maxAngleInternal; }
double vtkMeshValidity::GetWorstAngleBoundary() const { return this->Found->summary.maxAngleBoundary; }
double vtkMeshValidity::GetWorstWarpage() const { return this->Found->summary.maxWarpage; }
double vtkMeshValidity::GetWorstSkewInternal() const { return this->Found->summary.maxSkewInternal; }
double vtkMeshValidity::GetWorstSkewBoundary() const { return this->Found->summary.maxSkewBoundary; }
double vtkMeshValidity::GetWorstOpenness() const { return this->Found->summary.maxOpenness; }

void vtkMeshValidity::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Violations: " << this->GetViolations() << "\n";
  os << indent << "Description: " << this->GetDescription() << "\n";
}
