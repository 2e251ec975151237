// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "GridArrays.h"
#include "MeshPacking.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

/// Faces of a linear VTK cell, outward, as positions in the cell's point list.
struct CellShape {
  int vtkType;
  int points;
  std::vector<std::vector<int>> faces;
};

/// Null for any other type.

const CellShape* linearShape(int vtkType) {
  static const CellShape hexahedron{
      VTK_HEXAHEDRON,
      8,
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  static const CellShape voxel{
      VTK_VOXEL, 8, {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  static const CellShape wedge{
      VTK_WEDGE, 6, {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
  static const CellShape tetra{VTK_TETRA, 4, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}}};
  static const CellShape pyramid{VTK_PYRAMID, 5, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  for (const CellShape* shape : {&hexahedron, &voxel, &wedge, &tetra, &pyramid}) {
    if (shape->vtkType == vtkType) return shape;
  }
  return nullptr;
}

/// Faces as each cell has them: every internal face twice. A row starts at its smallest point and runs
/// outward.
struct HalfFaces {
  Csr<Id> rows;
  std::vector<Id> cell;
};

/// Read access to the grid's cells, whatever made them.
class CellReader {
 public:
  CellReader(vtkUnstructuredGrid* grid, const std::string& filter)
      : filter_(filter),
        cells_(grid->GetCells()),
        types_(grid->GetCellTypesArray()),
        points_(grid->GetNumberOfPoints()) {
    if (!cells_->IsStorage64Bit()) {  // the input itself stays as it is
      cells_ = vtkSmartPointer<vtkCellArray>::New();
      cells_->DeepCopy(grid->GetCells());
      cells_->ConvertTo64BitStorage();
    }
    offsets_ = cells_->GetOffsetsArray64()->GetPointer(0);
    connectivity_ = cells_->GetConnectivityArray64()->GetPointer(0);
    length_ = cells_->GetConnectivityArray64()->GetNumberOfValues();
    if (grid->GetFaces() && grid->GetFaceLocations()) {
      stream_ = grid->GetFaces()->GetPointer(0);
      streamLength_ = grid->GetFaces()->GetNumberOfValues();
      locations_ = grid->GetFaceLocations()->GetPointer(0);
    }
  }

  /// Calls body(point ids, how many) for each face of the cell, outward.
  template <class Body>
  void eachFace(Id cell, const Body& body) const {
    const int type = types_->GetValue(cell);
    if (type == VTK_POLYHEDRON) return eachFaceOfPolyhedron(cell, body);
    const CellShape* shape = linearShape(type);
    const bool known = shape && offsets_[cell] >= 0 && offsets_[cell + 1] <= length_ &&
                       offsets_[cell + 1] - offsets_[cell] == shape->points;
    if (!known) refuseChanged(filter_, "it holds cells of another kind");
    const vtkTypeInt64* ids = connectivity_ + offsets_[cell];
    std::array<vtkIdType, 4> row;
    for (const std::vector<int>& face : shape->faces) {
      std::transform(face.begin(), face.end(), row.begin(), [&](int i) { return ids[i]; });
      body(row.data(), static_cast<vtkIdType>(face.size()));
    }
  }

  Id checkedPoint(vtkIdType p) const {
    if (p < 0 || p >= points_) refuseChanged(filter_, "a cell names a point that does not exist");
    return static_cast<Id>(p);
  }

 private:
  template <class Body>
  void eachFaceOfPolyhedron(Id cell, const Body& body) const {
    vtkIdType at = stream_ ? locations_[cell] : -1;
    if (at < 0 || at >= streamLength_) refuseChanged(filter_, "a polyhedron has no faces");
    for (vtkIdType left = stream_[at++]; left > 0; --left) {
      const vtkIdType size = at < streamLength_ ? stream_[at++] : 0;
      if (size < 3 || size > streamLength_ - at) refuseChanged(filter_, "a polyhedron's faces are damaged");
      body(stream_ + at, size);
      at += size;
    }
  }

  const std::string& filter_;
  vtkSmartPointer<vtkCellArray> cells_;
  vtkUnsignedCharArray* types_;
  vtkIdType points_;
  const vtkTypeInt64* offsets_ = nullptr;
  const vtkTypeInt64* connectivity_ = nullptr;
  vtkTypeInt64 length_ = 0;
  const vtkIdType* stream_ = nullptr;
  const vtkIdType* locations_ = nullptr;
  vtkIdType streamLength_ = 0;
};

void prefixSum(std::vector<Id>& values) {
  std::exclusive_scan(values.begin(), values.end(), values.begin(), Id(0));
}

HalfFaces readHalfFaces(const CellReader& reader, Id cells) {
  std::vector<Id> faceStart(cells + 1, 0), valueStart(cells + 1, 0);
  tbb::parallel_for(Id(0), cells, [&](Id cell) {
    reader.eachFace(cell, [&](const vtkIdType*, vtkIdType size) {
      ++faceStart[cell];
      valueStart[cell] += static_cast<Id>(size);
    });
  });
  prefixSum(faceStart);
  prefixSum(valueStart);
  HalfFaces half;
  half.cell.resize(faceStart[cells]);
  half.rows.offsets.resize(faceStart[cells] + 1);
  half.rows.values.resize(valueStart[cells]);
  half.rows.offsets.back() = valueStart[cells];
  tbb::parallel_for(Id(0), cells, [&](Id cell) {
    Id face = faceStart[cell], value = valueStart[cell];
    reader.eachFace(cell, [&](const vtkIdType* row, vtkIdType size) {
      half.cell[face] = cell;
      half.rows.offsets[face++] = value;
      const vtkIdType* smallest = std::min_element(row, row + size);
      for (vtkIdType i = 0; i < size; ++i) {
        half.rows.values[value++] = reader.checkedPoint(row[(smallest - row + i) % size]);
      }
    });
  });
  return half;
}

/// Half faces by their smallest point: rows of half-face ids, ascending.
Csr<Id> byFirstPoint(const HalfFaces& half, Id points) {
  Csr<Id> buckets;
  buckets.offsets.assign(points + 1, 0);
  const Id count = half.rows.rows();
  for (Id h = 0; h < count; ++h) ++buckets.offsets[half.rows[h][0]];
  prefixSum(buckets.offsets);
  buckets.values.resize(count);
  std::vector<Id> next(buckets.offsets.begin(), buckets.offsets.end() - 1);
  for (Id h = 0; h < count; ++h) buckets.values[next[half.rows[h][0]]++] = h;
  return buckets;
}

/// Compares rows without regard to the way they run: -1, 0, 1.
int compareUnoriented(Span<Id> a, Span<Id> b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  const std::size_t n = a.size();
  const bool aBack = a[n - 1] < a[1], bBack = b[n - 1] < b[1];
  for (std::size_t i = 0; i < n; ++i) {
    const Id x = a[aBack && i > 0 ? n - i : i], y = b[bBack && i > 0 ? n - i : i];
    if (x != y) return x < y ? -1 : 1;
  }
  return 0;
}

/// The half face on the other side of each, kNone on the boundary.
std::vector<Id> matchHalfFaces(const HalfFaces& half, Csr<Id> buckets, const std::string& filter) {
  std::vector<Id> twin(half.cell.size(), kNone);
  tbb::parallel_for(Id(0), buckets.rows(), [&](Id point) {
    Id* first = buckets.values.data() + buckets.offsets[point];
    Id* last = buckets.values.data() + buckets.offsets[point + 1];
    std::sort(first, last, [&](Id a, Id b) {
      const int order = compareUnoriented(half.rows[a], half.rows[b]);
      return order != 0 ? order < 0 : a < b;
    });
    for (Id* h = first; h + 1 < last; ++h) {
      if (compareUnoriented(half.rows[h[0]], half.rows[h[1]]) != 0) continue;
      const bool sameWay = half.rows[h[0]][1] == half.rows[h[1]][1];
      const bool third = h + 2 < last && compareUnoriented(half.rows[h[0]], half.rows[h[2]]) == 0;
      if (sameWay || third) refuseChanged(filter, "cells overlap");
      twin[h[0]] = h[1];
      twin[h[1]] = h[0];
      ++h;
    }
  });
  return twin;
}

/// Faces with owner and neighbour from half faces; internal ones first, each from the smaller cell's side.
void joinHalfFaces(const HalfFaces& half, const std::vector<Id>& twin, PolyMesh& mesh) {
  const Id count = static_cast<Id>(twin.size());
  std::vector<Id> order;
  order.reserve(count);
  for (Id h = 0; h < count; ++h) {
    if (twin[h] > h) order.push_back(h);  // half faces ascend by cell, so this is the smaller cell's
  }
  const Id internal = static_cast<Id>(order.size());
  for (Id h = 0; h < count; ++h) {
    if (twin[h] == kNone) order.push_back(h);
  }
  const Id faces = static_cast<Id>(order.size());
  mesh.owner.resize(faces);
  mesh.neighbour.resize(internal);
  mesh.faces.offsets.assign(faces + 1, 0);
  for (Id f = 0; f < faces; ++f) mesh.faces.offsets[f] = static_cast<Id>(half.rows[order[f]].size());
  prefixSum(mesh.faces.offsets);
  mesh.faces.values.resize(mesh.faces.offsets.back());
  tbb::parallel_for(Id(0), faces, [&](Id f) {
    const Id h = order[f];
    mesh.owner[f] = half.cell[h];
    if (f < internal) mesh.neighbour[f] = half.cell[twin[h]];
    const Span<Id> row = half.rows[h];
    std::copy(row.begin(), row.end(), mesh.faces.values.begin() + mesh.faces.offsets[f]);
  });
  mesh.patch.assign(faces - internal, 0);
}

void readArrays(vtkUnstructuredGrid* grid, PolyMesh& mesh, const std::string& filter) {
  vtkFieldData* field = grid->GetFieldData();
  mesh.level = readArray<std::uint8_t>(grid->GetCellData(), "Level");
  mesh.layer = readArray<std::uint8_t>(grid->GetCellData(), "Layer");
  mesh.zoneNames = readStrings(field, "ZoneNames");
  if (!mesh.zoneNames.empty()) mesh.zone = readArray<Id>(grid->GetCellData(), "Zone", mesh.cellCount, filter);
  mesh.fixed = readArray<std::uint8_t>(grid->GetPointData(), "Fixed");
  mesh.base = readArray<Id>(grid->GetPointData(), "Base");
  mesh.patch = readArray<Id>(field, "BoundaryPatch", mesh.boundaryFaces(), filter);
  mesh.patchNames = readStrings(field, "PatchNames");
  mesh.patchTypes = readStrings(field, "PatchTypes");
  mesh.finestSize = readArray<double>(field, "FinestSize", 1, filter)[0];
  const Id patches = static_cast<Id>(mesh.patchNames.size());
  const bool inRange =
      std::all_of(mesh.patch.begin(), mesh.patch.end(), [&](Id p) { return p >= 0 && p < patches; });
  if (!inRange || mesh.patchTypes.size() != mesh.patchNames.size())
    refuseChanged(filter, "its patches have changed");
}

}  // namespace

bool isPacked(vtkUnstructuredGrid* grid) {
  return grid->GetFieldData()->HasArray("ProjectionMesherStamp") != 0;
}

PolyMesh unpackCells(vtkUnstructuredGrid* grid, const std::string& filter) {
  PolyMesh mesh;
  mesh.cellCount = static_cast<Id>(grid->GetNumberOfCells());
  if (mesh.cellCount == 0) throw InputError(filter + ": the input grid has no cells.");
  const Id points = static_cast<Id>(grid->GetNumberOfPoints());
  mesh.points.resize(points);
  tbb::parallel_for(Id(0), points, [&](Id p) { grid->GetPoints()->GetPoint(p, mesh.points[p].data()); });
  const HalfFaces half = readHalfFaces(CellReader(grid, filter), mesh.cellCount);
  joinHalfFaces(half, matchHalfFaces(half, byFirstPoint(half, points), filter), mesh);
  mesh.patchNames = {"boundary"};
  mesh.patchTypes = {"patch"};
  canonicalise(mesh);
  return mesh;
}

PolyMesh unpackMesh(vtkUnstructuredGrid* grid, const std::string& filter,
                    std::initializer_list<Stage> accepted) {
  const Stamp stamp = readStamp(grid, filter, accepted);
  PolyMesh mesh = unpackCells(grid, filter);
  mesh.stage = stamp.stage;
  if (mesh.boundaryFaces() != stamp.boundaryFaces) refuseChanged(filter, "its boundary has changed");
  readArrays(grid, mesh, filter);
  if (checksum(mesh) != stamp.sum) {
    refuseChanged(filter, "its points or arrays have changed");
  }
  return mesh;
}

}  // namespace pm
