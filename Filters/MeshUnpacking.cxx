// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
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

/// Faces of a linear VTK cell, outward, as positions in the cell's point list; -1 fills up a triangle.
struct CellShape {
  int points, faces;
  std::array<std::array<int, 4>, 6> face;
  int faceSize(int k) const { return face[k][3] < 0 ? 3 : 4; }
};

constexpr CellShape kHexahedron{
    8, 6, {{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}}};
constexpr CellShape kVoxel{
    8, 6, {{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}}};
constexpr CellShape kWedge{6, 5, {{{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}}};
constexpr CellShape kTetra{4, 4, {{{0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}, {0, 2, 1, -1}}}};
constexpr CellShape kPyramid{
    5, 5, {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}}};

/// Null for any other type.
const CellShape* linearShape(int vtkType) {
  switch (vtkType) {
    case VTK_HEXAHEDRON:
      return &kHexahedron;
    case VTK_VOXEL:
      return &kVoxel;
    case VTK_WEDGE:
      return &kWedge;
    case VTK_TETRA:
      return &kTetra;
    case VTK_PYRAMID:
      return &kPyramid;
    default:
      return nullptr;
  }
}

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
    for (int k = 0; k < shape->faces; ++k) {
      const int size = shape->faceSize(k);
      for (int i = 0; i < size; ++i) row[i] = ids[shape->face[k][i]];
      body(row.data(), size);
    }
  }

  /// Face k of a cell that eachFace has been through, outward, from its smallest point on.
  void readFace(Id cell, Id k, std::vector<Id>& row) const {
    row.clear();
    const int type = types_->GetValue(cell);
    if (type == VTK_POLYHEDRON) {
      const vtkIdType* at = stream_ + locations_[cell] + 1;
      for (; k > 0; --k) at += *at + 1;
      row.resize(*at);
      std::transform(at + 1, at + 1 + *at, row.begin(), [](vtkIdType p) { return static_cast<Id>(p); });
    } else {
      const CellShape& shape = *linearShape(type);
      const vtkTypeInt64* ids = connectivity_ + offsets_[cell];
      row.resize(shape.faceSize(k));
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<Id>(ids[shape.face[k][i]]);
    }
    std::rotate(row.begin(), std::min_element(row.begin(), row.end()), row.end());
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

/// Faces as each cell has them, every internal face twice, numbered cell by cell. Their points stay in the
/// grid and are read from there, for all of them together would be twice the mesh.
class HalfFaces {
 public:
  HalfFaces(const CellReader& reader, Id cells) : reader_(reader), start_(cells + 1, 0) {
    tbb::parallel_for(Id(0), cells, [&](Id cell) {
      reader.eachFace(cell, [&](const vtkIdType*, vtkIdType) { ++start_[cell]; });
    });
    prefixSum(start_);
    cell_.resize(start_[cells]);
    tbb::parallel_for(Id(0), cells, [&](Id cell) {
      std::fill(cell_.begin() + start_[cell], cell_.begin() + start_[cell + 1], cell);
    });
  }

  Id count() const { return static_cast<Id>(cell_.size()); }
  Id cell(Id half) const { return cell_[half]; }
  void read(Id half, std::vector<Id>& row) const {
    reader_.readFace(cell_[half], half - start_[cell_[half]], row);
  }
  /// The smallest point of each. Throws InputError for points that do not exist.
  std::vector<Id> firstPoints() const {
    std::vector<Id> first(count());
    tbb::parallel_for(Id(0), static_cast<Id>(start_.size()) - 1, [&](Id cell) {
      Id half = start_[cell];
      reader_.eachFace(cell, [&](const vtkIdType* row, vtkIdType size) {
        Id& smallest = first[half++];
        smallest = std::numeric_limits<Id>::max();
        for (vtkIdType i = 0; i < size; ++i) smallest = std::min(smallest, reader_.checkedPoint(row[i]));
      });
    });
    return first;
  }

 private:
  const CellReader& reader_;
  std::vector<Id> start_;  // #C + 1 first half face of each cell
  std::vector<Id> cell_;
};

/// Half faces by their smallest point: rows of half-face ids, ascending.
Csr<Id> byFirstPoint(const HalfFaces& half, Id points) {
  const std::vector<Id> first = half.firstPoints();
  Csr<Id> buckets;
  buckets.offsets.assign(points + 1, 0);
  for (Id p : first) ++buckets.offsets[p];
  prefixSum(buckets.offsets);
  buckets.values.resize(first.size());
  std::vector<Id> next(buckets.offsets.begin(), buckets.offsets.end() - 1);
  for (Id h = 0; h < half.count(); ++h) buckets.values[next[first[h]]++] = h;
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

/// Finds twins among the half faces of one smallest point.
class TwinFinder {
 public:
  TwinFinder(const HalfFaces& half, const std::string& filter) : half_(half), filter_(filter) {}

  void find(Span<Id> bucket, std::vector<Id>& twin) {
    sort(bucket);
    for (std::size_t i = 0; i + 1 < order_.size(); ++i) {
      if (!areEqual(i, i + 1)) continue;
      const bool sameWay = row(i)[1] == row(i + 1)[1];
      if (sameWay || (i + 2 < order_.size() && areEqual(i, i + 2))) refuseChanged(filter_, "cells overlap");
      const Id one = bucket[order_[i].place], other = bucket[order_[i + 1].place];
      twin[one] = other;
      twin[other] = one;
      ++i;
    }
  }

 private:
  /// The points beside the smallest, the smaller of them first; they tell nearly all faces apart.
  struct Entry {
    std::uint64_t key;
    Id place;
  };
  void sort(Span<Id> bucket) {
    rows_.clear();
    order_.clear();
    for (Id place = 0; place < static_cast<Id>(bucket.size()); ++place) {
      half_.read(bucket[place], row_);
      rows_.push(row_);
      const auto [low, high] = std::minmax(row_[1], row_.back());
      order_.push_back({std::uint64_t(low) << 32 | std::uint64_t(high), place});
    }
    std::sort(order_.begin(), order_.end(), [&](const Entry& a, const Entry& b) {
      if (a.key != b.key) return a.key < b.key;
      const int order = compareUnoriented(rows_[a.place], rows_[b.place]);
      return order != 0 ? order < 0 : a.place < b.place;
    });
  }
  Span<Id> row(std::size_t i) const { return rows_[order_[i].place]; }
  bool areEqual(std::size_t i, std::size_t j) const {
    return order_[i].key == order_[j].key && compareUnoriented(row(i), row(j)) == 0;
  }

  const HalfFaces& half_;
  const std::string& filter_;
  Csr<Id> rows_;
  std::vector<Entry> order_;
  std::vector<Id> row_;
};

/// The half face on the other side of each, kNone on the boundary.
std::vector<Id> matchHalfFaces(const HalfFaces& half, Id points, const std::string& filter) {
  const Csr<Id> buckets = byFirstPoint(half, points);
  std::vector<Id> twin(half.count(), kNone);
  tbb::parallel_for(tbb::blocked_range<Id>(0, points, 256), [&](const tbb::blocked_range<Id>& range) {
    TwinFinder finder(half, filter);
    for (Id point = range.begin(); point != range.end(); ++point) finder.find(buckets[point], twin);
  });
  return twin;
}

/// Room that is not used costs nothing; without it the first faces that a stage adds would copy the mesh's,
/// at the stage's peak of memory.
void resizeWithRoom(std::vector<Id>& values, std::size_t size) {
  values.reserve(size + size / 16);
  values.resize(size, 0);
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
  mesh.neighbour.resize(internal);
  resizeWithRoom(mesh.owner, faces);
  resizeWithRoom(mesh.faces.offsets, faces + 1);
  const auto forRows = [&](const auto& body) {
    tbb::parallel_for(tbb::blocked_range<Id>(0, faces, 1024), [&](const tbb::blocked_range<Id>& range) {
      std::vector<Id> row;
      for (Id f = range.begin(); f != range.end(); ++f) {
        half.read(order[f], row);
        body(f, row);
      }
    });
  };
  forRows([&](Id f, const std::vector<Id>& row) {
    mesh.owner[f] = half.cell(order[f]);
    if (f < internal) mesh.neighbour[f] = half.cell(twin[order[f]]);
    mesh.faces.offsets[f] = static_cast<Id>(row.size());
  });
  prefixSum(mesh.faces.offsets);
  resizeWithRoom(mesh.faces.values, mesh.faces.offsets.back());
  forRows([&](Id f, const std::vector<Id>& row) {
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
  {
    const CellReader reader(grid, filter);
    const HalfFaces half(reader, mesh.cellCount);
    joinHalfFaces(half, matchHalfFaces(half, points, filter), mesh);
  }
  mesh.points.resize(points);
  tbb::parallel_for(Id(0), points, [&](Id p) { grid->GetPoints()->GetPoint(p, mesh.points[p].data()); });
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
