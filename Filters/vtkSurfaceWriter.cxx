// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSurfaceWriter.h"

#include <array>
#include <filesystem>
#include <map>

#include "GridArrays.h"
#include "StageMonitor.h"
#include "StlWriter.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkErrorCode.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

namespace {

/// Polygons and strips of the surface, strips as triangles; patch: of each of the surface's cells.
void addPolygons(vtkPolyData* surface, const std::vector<pm::Id>& patch, pm::PolygonSurface& out) {
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell) {
    const int type = surface->GetCellType(cell);
    surface->GetCellPoints(cell, ids);
    const vtkIdType* p = ids->GetPointer(0);
    const vtkIdType count = ids->GetNumberOfIds();
    if (count < 3) continue;
    if (type == VTK_TRIANGLE_STRIP) {
      for (vtkIdType i = 0; i + 2 < count; ++i) {
        out.polygons.push(std::array<vtkIdType, 3>{p[i + i % 2], p[i + 1 - i % 2], p[i + 2]});
        out.patch.push_back(patch[cell]);
      }
    } else if (type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON) {
      out.polygons.push(std::vector<vtkIdType>(p, p + count));
      out.patch.push_back(patch[cell]);
    }
  }
}

/// stem: of the file, the name of what has none.
pm::PolygonSurface polygonsOf(vtkPolyData* surface, const std::string& stem) {
  pm::PolygonSurface out;
  out.points.resize(surface->GetNumberOfPoints());
  for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p) surface->GetPoint(p, out.points[p].data());
  // Ids as they are in the array may have gaps, or no name.
  std::vector<pm::Id> patch = pm::readArray<pm::Id>(surface->GetCellData(), "PatchId");
  const bool hasPatches = static_cast<vtkIdType>(patch.size()) == surface->GetNumberOfCells();
  if (!hasPatches) patch.assign(surface->GetNumberOfCells(), 0);
  std::map<pm::Id, pm::Id> indexOf;
  for (pm::Id id : patch) indexOf[id] = 0;
  const std::vector<std::string> names = pm::readStrings(surface->GetFieldData(), "PatchNames");
  for (auto& [id, index] : indexOf) {
    index = static_cast<pm::Id>(out.patchNames.size());
    const bool named = id >= 0 && id < static_cast<pm::Id>(names.size());
    out.patchNames.push_back(!hasPatches ? stem : named ? names[id] : "patch_" + std::to_string(id));
  }
  for (pm::Id& id : patch) id = indexOf[id];
  addPolygons(surface, patch, out);
  return out;
}

}  // namespace

vtkStandardNewMacro(vtkSurfaceWriter);

vtkSurfaceWriter::~vtkSurfaceWriter() { this->SetFileName(nullptr); }

int vtkSurfaceWriter::FillInputPortInformation(int, vtkInformation* info) {
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

void vtkSurfaceWriter::WriteData() {
  try {
    if (!this->FileName || !*this->FileName) {
      throw pm::InputError("No place to write to; set FileName (an .stl file).");
    }
    const std::string stem = std::filesystem::path(this->FileName).stem().string();
    pm::StageMonitor monitor(this);
    pm::writeStl(polygonsOf(vtkPolyData::SafeDownCast(this->GetInput()), stem), this->FileName, monitor);
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    this->SetErrorCode(vtkErrorCode::CannotOpenFileError);
  }
}

void vtkSurfaceWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}
