// SPDX-License-Identifier: BSD-3-Clause
#include "LinearCells.h"

#include <array>
#include <utility>

#include "vtkCell.h"
#include "vtkCellType.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

/// Faces of a cell type as positions in the cell's list of points; none for a type that has no such list.
using Shape = std::vector<std::vector<int>>;

/// VTK's own cells say what their faces are.
Shape makeShape(int vtkType) {
  vtkNew<vtkGenericCell> cell;
  cell->SetCellType(vtkType);
  for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) cell->GetPointIds()->SetId(i, i);
  Shape shape;
  for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
    vtkCell* face = cell->GetFace(f);
    vtkIdList* ids = face->GetPointIds();
    shape.emplace_back(ids->begin(), ids->end());
    if (face->GetCellType() == VTK_PIXEL) std::swap(shape.back()[2], shape.back()[3]);
  }
  return shape;
}

const Shape& shapeOf(int vtkType) {
  static const std::array<Shape, VTK_HEXAGONAL_PRISM + 1> shapes = [] {
    std::array<Shape, VTK_HEXAGONAL_PRISM + 1> made;
    for (const int type : {VTK_TETRA, VTK_VOXEL, VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID, VTK_PENTAGONAL_PRISM,
                           VTK_HEXAGONAL_PRISM})
      made[type] = makeShape(type);
    return made;
  }();
  static const Shape none;
  return vtkType >= 0 && vtkType <= VTK_HEXAGONAL_PRISM ? shapes[vtkType] : none;
}

class FaceReader {
 public:
  FaceReader(vtkUnstructuredGrid* grid, const std::string& filter) : grid_(grid), filter_(filter) {}

  void add(vtkIdType cell) {
    row_.clear();
    if (grid_->GetCellType(cell) == VTK_POLYHEDRON) {
      addPolyhedron(cell);
    } else {
      addLinear(cell, shapeOf(grid_->GetCellType(cell)));
    }
    rows_.cells.push(row_);
  }
  FaceRows take() { return std::move(rows_); }

 private:
  void addLinear(vtkIdType cell, const Shape& shape) {
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    grid_->GetCellPoints(cell, count, points, ids_);
    for (const std::vector<int>& corners : shape) {
      face_.clear();
      for (const int corner : corners) face_.push_back(corner < count ? checked(points[corner]) : damaged());
      addFace();
    }
  }

  void addPolyhedron(vtkIdType cell) {
    vtkIdTypeArray *stream = grid_->GetFaces(), *locations = grid_->GetFaceLocations();
    const vtkIdType end = stream && locations ? stream->GetNumberOfValues() : 0;
    vtkIdType at = end > 0 ? locations->GetValue(cell) : -1;
    if (at < 0 || at >= end) damaged();
    for (vtkIdType left = stream->GetValue(at++); left > 0; --left) {
      const vtkIdType size = at < end ? stream->GetValue(at++) : 0;
      if (size < 3 || size > end - at) damaged();
      face_.clear();
      for (vtkIdType i = 0; i < size; ++i) face_.push_back(checked(stream->GetValue(at++)));
      addFace();
    }
  }

  void addFace() {
    row_.push_back(rows_.faces.rows());
    rows_.faces.push(face_);
  }

  Id checked(vtkIdType point) const {
    return point >= 0 && point < grid_->GetNumberOfPoints() ? static_cast<Id>(point) : damaged();
  }
  [[noreturn]] Id damaged() const {
    throw InputError(filter_ +
                     ": a cell of the grid is damaged, its points or faces do not exist; "
                     "read the grid again or make it anew.");
  }

  vtkUnstructuredGrid* grid_;
  const std::string& filter_;
  FaceRows rows_;
  std::vector<Id> row_, face_;
  vtkNew<vtkIdList> ids_;
};

}  // namespace

bool hasStraightEdges(int vtkType) { return vtkType == VTK_POLYHEDRON || !shapeOf(vtkType).empty(); }

FaceRows facesOf(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& chosen, const std::string& filter) {
  FaceReader reader(grid, filter);
  for (const vtkIdType cell : chosen) reader.add(cell);
  return reader.take();
}

}  // namespace pm
