// SPDX-License-Identifier: BSD-3-Clause
#include "FeaturePacking.h"

#include "GridArrays.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTreeRange.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

namespace pm {
namespace {

/// Cells of their own points.
class LinePacker {
 public:
  LinePacker() { this->Points->SetDataTypeToDouble(); }

  void AddVertex(const Vec3& p) {
    const vtkIdType point = this->Points->InsertNextPoint(p.data());
    this->Vertices->InsertNextCell(1, &point);
  }
  void AddLine(const std::vector<Vec3>& points, bool closed) {
    const vtkIdType first = this->Points->GetNumberOfPoints();
    this->Lines->InsertNextCell(static_cast<vtkIdType>(points.size()) + (closed ? 1 : 0));
    for (const Vec3& p : points) this->Lines->InsertCellPoint(this->Points->InsertNextPoint(p.data()));
    if (closed) this->Lines->InsertCellPoint(first);
  }
  void Finish(vtkPolyData* out) {
    out->SetPoints(this->Points);
    out->SetVerts(this->Vertices);
    out->SetLines(this->Lines);
  }

 private:
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Vertices, Lines;
};

void addLines(vtkPolyData* data, std::vector<std::vector<Vec3>>& lines) {
  if (data == nullptr || data->GetNumberOfLines() == 0) return;
  const auto cell = vtk::TakeSmartPointer(data->GetLines()->NewIterator());
  for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
    vtkIdType count;
    const vtkIdType* ids;
    cell->GetCurrentCell(count, ids);
    std::vector<Vec3>& line = lines.emplace_back(count);
    for (vtkIdType i = 0; i < count; ++i) data->GetPoint(ids[i], line[i].data());
  }
}

}  // namespace

void packCurves(const FeatureGraph& graph, vtkPolyData* lines) {
  LinePacker packer;
  const std::size_t corners = graph.corners().size(), curves = graph.curves().size();
  std::vector<int> kind(corners + curves, 0), row(corners + curves, -1);
  std::vector<double> length(corners + curves, 0.0);
  for (const FeatureSegment& segment : graph.segments()) kind[corners + segment.curve] |= segment.kind;
  for (const Vec3& corner : graph.corners()) packer.AddVertex(corner);
  for (std::size_t c = 0; c < curves; ++c) {
    const FeatureCurve& curve = graph.curves()[c];
    packer.AddLine(curve.points, curve.closed);
    row[corners + c] = static_cast<int>(c);
    length[corners + c] = curve.length();
  }
  packer.Finish(lines);
  addArray<vtkIntArray>(lines->GetCellData(), "Kind", kind);
  addArray<vtkIntArray>(lines->GetCellData(), "Curve", row);
  addArray<vtkDoubleArray>(lines->GetCellData(), "Length", length);
}

void packUnresolved(const std::vector<UnresolvedFeature>& parts, vtkPolyData* lines) {
  LinePacker packer;
  std::vector<int> curve;
  std::vector<unsigned char> reason;
  std::vector<std::string> why;
  std::vector<double> length, size;
  for (const UnresolvedFeature& part : parts) {
    packer.AddLine(part.points, false);
    curve.push_back(part.curve);
    reason.push_back(static_cast<unsigned char>(part.why));
    why.push_back(part.why == Unresolved::Limit ? describe(part.limit) : describe(part.why));
    length.push_back(part.length);
    size.push_back(part.size);
  }
  packer.Finish(lines);
  addArray<vtkIntArray>(lines->GetCellData(), "Curve", curve);
  addArray<vtkUnsignedCharArray>(lines->GetCellData(), "Reason", reason);
  if (!why.empty()) addStrings(lines->GetCellData(), "Why", why);
  addArray<vtkDoubleArray>(lines->GetCellData(), "Length", length);
  addArray<vtkDoubleArray>(lines->GetCellData(), "NeededSize", size);
}

std::vector<std::vector<Vec3>> curvesFrom(vtkDataObject* object) {
  std::vector<std::vector<Vec3>> lines;
  if (object == nullptr) return lines;
  addLines(vtkPolyData::SafeDownCast(object), lines);
  if (auto* tree = vtkDataObjectTree::SafeDownCast(object))
    for (vtkDataObject* block : vtk::Range(
             tree, vtk::DataObjectTreeOptions::TraverseSubTree | vtk::DataObjectTreeOptions::VisitOnlyLeaves))
      addLines(vtkPolyData::SafeDownCast(block), lines);
  if (lines.empty())
    throw InputError("The feature curves contain no lines; give a polydata of polylines or disconnect it.");
  return lines;
}

}  // namespace pm
