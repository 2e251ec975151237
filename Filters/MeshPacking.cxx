// SPDX-License-Identifier: BSD-3-Clause
#include "MeshPacking.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <numeric>

#include "CellRecognition.h"
#include "GridArrays.h"

namespace pm {

namespace {

template <class Body>
void forBlocks(Id count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Id>(0, count, 1024), [&](const tbb::blocked_range<Id>& block) {
    CellRecogniser recogniser;
    for (Id i = block.begin(); i != block.end(); ++i) body(i, recogniser);
  });
}

/// Exclusive sums in place; the last element becomes the total.
template <class T>
void prefixSum(T* values, Id count) {
  std::exclusive_scan(values, values + count + 1, values, T(0));
}

vtkSmartPointer<vtkPoints> newPoints(Id count) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(count);
  return points;
}

double* coordinates(vtkPoints* points) { return static_cast<double*>(points->GetVoidPointer(0)); }

/// The arrays of a grid's cells while they are counted and filled.
struct CellArrays {
  vtkNew<vtkUnsignedCharArray> types;
  vtkNew<vtkTypeInt64Array> offsets, connectivity;
  vtkNew<vtkIdTypeArray> faceLocations, faceStream;
};

/// Types, and per cell the lengths of its point list and of its face stream, then their sums. Returns the
/// length of the whole face stream, 0 when no cell is a polyhedron.
vtkIdType countCells(const PolyMesh& mesh, const Csr<Id>& facesOf, CellArrays& out) {
  const Id cells = mesh.cellCount;
  out.types->SetNumberOfValues(cells);
  out.offsets->SetNumberOfValues(cells + 1);
  out.faceLocations->SetNumberOfValues(cells + 1);
  unsigned char* types = out.types->GetPointer(0);
  vtkTypeInt64* offsets = out.offsets->GetPointer(0);
  vtkIdType* locations = out.faceLocations->GetPointer(0);
  offsets[cells] = locations[cells] = 0;
  forBlocks(cells, [&](Id cell, CellRecogniser& recogniser) {
    const RecognisedCell& found = recogniser.recognise(mesh, facesOf[cell], cell);
    types[cell] = static_cast<unsigned char>(found.vtkType);
    offsets[cell] = static_cast<vtkIdType>(found.points.size());
    locations[cell] = 0;
    if (found.vtkType != VTK_POLYHEDRON) return;
    locations[cell] = 1;
    for (Id face : facesOf[cell]) locations[cell] += 1 + static_cast<vtkIdType>(mesh.faces[face].size());
  });
  prefixSum(offsets, cells);
  prefixSum(locations, cells);
  return locations[cells];
}

void fillFaceStream(const PolyMesh& mesh, Span<Id> faces, Id cell, vtkIdType* out) {
  *out++ = static_cast<vtkIdType>(faces.size());
  for (Id face : faces) {
    const Span<Id> row = mesh.faces[face];
    *out++ = static_cast<vtkIdType>(row.size());
    out = mesh.owner[face] == cell ? std::copy(row.begin(), row.end(), out)
                                   : std::reverse_copy(row.begin(), row.end(), out);
  }
}

void setCells(const PolyMesh& mesh, vtkUnstructuredGrid* grid) {
  const Csr<Id> facesOf = cellFaces(mesh);
  CellArrays arrays;
  const vtkIdType streamLength = countCells(mesh, facesOf, arrays);
  const vtkTypeInt64* offsets = arrays.offsets->GetPointer(0);
  vtkIdType* locations = arrays.faceLocations->GetPointer(0);
  arrays.connectivity->SetNumberOfValues(offsets[mesh.cellCount]);
  arrays.faceStream->SetNumberOfValues(streamLength);
  vtkTypeInt64* connectivity = arrays.connectivity->GetPointer(0);
  vtkIdType* stream = arrays.faceStream->GetPointer(0);
  const unsigned char* types = arrays.types->GetPointer(0);
  forBlocks(mesh.cellCount, [&](Id cell, CellRecogniser& recogniser) {
    const RecognisedCell& found = recogniser.recognise(mesh, facesOf[cell], cell);
    std::copy(found.points.begin(), found.points.end(), connectivity + offsets[cell]);
    if (types[cell] == VTK_POLYHEDRON) fillFaceStream(mesh, facesOf[cell], cell, stream + locations[cell]);
  });
  for (Id cell = 0; cell < mesh.cellCount; ++cell) {
    if (types[cell] != VTK_POLYHEDRON) locations[cell] = -1;
  }
  arrays.faceLocations->SetNumberOfValues(mesh.cellCount);
  vtkNew<vtkCellArray> cells;
  cells->SetData(arrays.offsets, arrays.connectivity);
  grid->SetCells(arrays.types, cells, streamLength > 0 ? arrays.faceLocations.Get() : nullptr,
                 streamLength > 0 ? arrays.faceStream.Get() : nullptr);
}

/// Position of each mesh point among those that boundary faces use, kNone for the others.
std::vector<Id> numberBoundaryPoints(const PolyMesh& mesh, Id& used) {
  std::vector<Id> number(mesh.points.size(), kNone);
  const Id first = mesh.faces.offsets[mesh.internalFaces()];
  for (std::size_t i = first; i < mesh.faces.values.size(); ++i) number[mesh.faces.values[i]] = 0;
  used = 0;
  for (Id& n : number) {
    if (n != kNone) n = used++;
  }
  return number;
}

}  // namespace

void packMesh(const PolyMesh& mesh, vtkUnstructuredGrid* grid) {
  grid->Initialize();
  const Id count = static_cast<Id>(mesh.points.size());
  const auto points = newPoints(count);
  double* xyz = coordinates(points);
  tbb::parallel_for(Id(0), count,
                    [&](Id p) { std::copy_n(mesh.points[p].data(), 3, xyz + 3 * std::size_t(p)); });
  grid->SetPoints(points);
  setCells(mesh, grid);

  addArray<vtkUnsignedCharArray>(grid->GetCellData(), "Level", mesh.level);
  addArray<vtkUnsignedCharArray>(grid->GetCellData(), "Layer", mesh.layer);
  addArray<vtkTypeInt32Array>(grid->GetCellData(), "Zone", mesh.zone);
  addArray<vtkUnsignedCharArray>(grid->GetPointData(), "Fixed", mesh.fixed);
  addArray<vtkTypeInt32Array>(grid->GetPointData(), "Base", mesh.base);
  vtkFieldData* field = grid->GetFieldData();
  addArray<vtkTypeInt32Array>(field, "BoundaryPatch", mesh.patch);
  addStrings(field, "PatchNames", mesh.patchNames);
  addStrings(field, "PatchTypes", mesh.patchTypes);
  if (!mesh.zoneNames.empty()) addStrings(field, "ZoneNames", mesh.zoneNames);
  addArray<vtkDoubleArray>(field, "FinestSize", std::vector<double>{mesh.finestSize});
  addStamp(grid, mesh.stage, mesh.boundaryFaces(), checksum(mesh));
}

void packBoundary(const PolyMesh& mesh, vtkPolyData* surface) {
  surface->Initialize();
  Id used = 0;
  const std::vector<Id> number = numberBoundaryPoints(mesh, used);
  const auto points = newPoints(used);
  double* xyz = coordinates(points);
  tbb::parallel_for(Id(0), static_cast<Id>(number.size()), [&](Id p) {
    if (number[p] != kNone) std::copy_n(mesh.points[p].data(), 3, xyz + 3 * std::size_t(number[p]));
  });
  surface->SetPoints(points);

  const Id first = mesh.internalFaces(), faces = mesh.boundaryFaces();
  const Id start = mesh.faces.offsets[first];
  vtkNew<vtkTypeInt64Array> offsets, connectivity;
  offsets->SetNumberOfValues(faces + 1);
  connectivity->SetNumberOfValues(mesh.faces.offsets.back() - start);
  std::transform(mesh.faces.offsets.begin() + first, mesh.faces.offsets.end(), offsets->GetPointer(0),
                 [&](Id offset) { return offset - start; });
  std::transform(mesh.faces.values.begin() + start, mesh.faces.values.end(), connectivity->GetPointer(0),
                 [&](Id p) { return number[p]; });
  vtkNew<vtkCellArray> polys;
  polys->SetData(offsets, connectivity);
  surface->SetPolys(polys);
  addArray<vtkTypeInt32Array>(surface->GetCellData(), "PatchId", mesh.patch);
  addStrings(surface->GetFieldData(), "PatchNames", mesh.patchNames);
  addStrings(surface->GetFieldData(), "PatchTypes", mesh.patchTypes);
}

}  // namespace pm
