// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMeshSlice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "LinearCells.h"
#include "MeshSlice.h"
#include "vtkAppendPolyData.h"
#include "vtkArrayListTemplate.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCutter.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkExtractCells.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkMeshSlice);

vtkMeshSlice::vtkMeshSlice() : vtkMeshStage(1, -1, 1), Plane(vtkSmartPointer<vtkPlane>::New()) {}

void vtkMeshSlice::SetPlane(vtkPlane* plane) {
  if (this->Plane == plane) return;
  this->Plane = plane;
  this->Modified();
}

vtkMTimeType vtkMeshSlice::GetMTime() {
  return std::max(this->Superclass::GetMTime(), this->Plane ? this->Plane->GetMTime() : 0);
}

vtkDataSet* vtkMeshSlice::GetOutput() { return vtkDataSet::SafeDownCast(this->GetOutputDataObject(0)); }

int vtkMeshSlice::FillOutputPortInformation(int, vtkInformation* info) {
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataSet");
  return 1;
}

vtkTypeBool vtkMeshSlice::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
  if (!request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
    return this->Superclass::ProcessRequest(request, inputs, outputs);
  vtkDataObject* output = vtkDataObject::GetData(outputs, 0);
  const bool fits = output && output->IsA(this->Crinkle ? "vtkUnstructuredGrid" : "vtkPolyData");
  if (!fits) {
    vtkSmartPointer<vtkDataObject> made;
    if (this->Crinkle) {
      made = vtkSmartPointer<vtkUnstructuredGrid>::New();
    } else {
      made = vtkSmartPointer<vtkPolyData>::New();
    }
    outputs->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
  return 1;
}

namespace {

/// Whatever the plane's class makes of its parameters, it is an affine function of the place.
pm::SlicePlane planeOf(vtkPlane* plane) {
  pm::SlicePlane result;
  double gradient[3] = {0, 0, 0}, value = 0;
  if (plane) {
    plane->GetOrigin(result.origin.data());
    value = plane->FunctionValue(result.origin.data());
    plane->FunctionGradient(result.origin.data(), gradient);
  }
  const pm::Vec3 normal(gradient[0], gradient[1], gradient[2]);
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(value))
    throw pm::InputError("Mesh Slice: the plane has no direction; give it a normal, such as 0 0 1.");
  result.normal = normal / length;
  result.origin -= value / length * result.normal;
  return result;
}

/// What rounding of the coordinates can make of a distance to the plane.
double roundingOf(vtkPoints* points, const pm::SlicePlane& plane) {
  double bounds[6], sum = 0;
  points->GetBounds(bounds);
  for (int a = 0; a < 3; ++a) {
    const double largest =
        std::max({std::abs(bounds[2 * a]), std::abs(bounds[2 * a + 1]), std::abs(plane.origin[a])});
    sum += std::abs(plane.normal[a]) * largest;
  }
  return sum * (points->GetDataType() == VTK_FLOAT ? 4 * double(FLT_EPSILON) : 1e-12);
}

std::vector<double> signedDistances(vtkPoints* points, const pm::SlicePlane& plane) {
  const double tolerance = roundingOf(points, plane);
  std::vector<double> distance(points->GetNumberOfPoints());
  tbb::parallel_for(std::size_t(0), distance.size(), [&](std::size_t p) {
    pm::Vec3 x;
    points->GetPoint(static_cast<vtkIdType>(p), x.data());
    distance[p] = plane.distance(x, tolerance);
  });
  return distance;
}

/// Cells with points in the plane or on both its sides; those with points that are nowhere are left out.
std::vector<char> cellsAtPlane(vtkUnstructuredGrid* grid, const std::vector<double>& distance) {
  std::vector<char> at(grid->GetNumberOfCells());
  vtkCellArray* cells = grid->GetCells();
  const vtkIdType known = static_cast<vtkIdType>(distance.size());
  tbb::parallel_for(tbb::blocked_range<vtkIdType>(0, grid->GetNumberOfCells(), 4096), [&](const auto& range) {
    vtkNew<vtkIdList> ids;
    for (vtkIdType c = range.begin(); c < range.end(); ++c) {
      vtkIdType count = 0;
      const vtkIdType* points = nullptr;
      cells->GetCellAtId(c, count, points, ids);
      double lowest = HUGE_VAL, highest = -HUGE_VAL;
      bool sound = true;
      for (vtkIdType i = 0; i < count; ++i) {
        sound = points[i] >= 0 && points[i] < known && std::isfinite(distance[points[i]]);
        if (!sound) break;
        lowest = std::min(lowest, distance[points[i]]);
        highest = std::max(highest, distance[points[i]]);
      }
      at[c] = sound && lowest <= 0 && highest >= 0;
    }
  });
  return at;
}

void addIds(const std::vector<vtkIdType>& values, vtkCellData* data) {
  vtkNew<vtkIdTypeArray> array;
  array->SetName("vtkOriginalCellIds");
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  data->AddArray(array);
}

void fillPoints(const pm::PlaneSection& section, vtkUnstructuredGrid* grid, vtkPolyData* output) {
  const vtkIdType count = static_cast<vtkIdType>(section.points.size());
  vtkNew<vtkPoints> points;
  points->SetDataType(grid->GetPoints()->GetDataType());
  points->SetNumberOfPoints(count);
  output->GetPointData()->InterpolateAllocate(grid->GetPointData(), count);
  ArrayList arrays;
  arrays.AddArrays(count, grid->GetPointData(), output->GetPointData(), 0.0, false);
  tbb::parallel_for(vtkIdType(0), count, [&](vtkIdType i) {
    const pm::EdgeCrossing& at = section.points[i];
    pm::Vec3 low, high;
    grid->GetPoints()->GetPoint(at.low, low.data());
    grid->GetPoints()->GetPoint(at.high, high.data());
    points->SetPoint(i, pm::Vec3(low + at.part * (high - low)).data());
    arrays.InterpolateEdge(at.low, at.high, at.part, i);
  });
  output->SetPoints(points);
}

void fillPolygons(const pm::PlaneSection& section, const std::vector<vtkIdType>& cells,
                  vtkUnstructuredGrid* grid, vtkPolyData* output) {
  vtkNew<vtkCellArray> polygons;
  vtkNew<vtkIdTypeArray> offsets, connectivity;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(section.polygons.offsets.size()));
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(section.polygons.values.size()));
  std::copy(section.polygons.offsets.begin(), section.polygons.offsets.end(), offsets->GetPointer(0));
  std::copy(section.polygons.values.begin(), section.polygons.values.end(), connectivity->GetPointer(0));
  polygons->SetData(offsets, connectivity);
  output->SetPolys(polygons);
  vtkNew<vtkIdList> from;
  for (const vtkIdType cell : cells) from->InsertNextId(cell);
  output->GetCellData()->CopyAllocate(grid->GetCellData(), from->GetNumberOfIds());
  output->GetCellData()->CopyData(grid->GetCellData(), from);
  addIds(cells, output->GetCellData());
}

/// The cells themselves, ids ascending.
void extract(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& cells, vtkUnstructuredGrid* output) {
  vtkNew<vtkExtractCells> extractor;
  extractor->SetInputData(grid);
  extractor->SetCellIds(cells.data(), static_cast<vtkIdType>(cells.size()));
  extractor->AssumeSortedAndUniqueIdsOn();
  extractor->Update();
  output->ShallowCopy(extractor->GetOutput());
}

/// Adds what VTK's own cutter makes of cells that are no solids with straight edges.
void appendOthers(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& cells, const pm::SlicePlane& plane,
                  vtkPolyData* output) {
  vtkNew<vtkUnstructuredGrid> others;
  extract(grid, cells, others);
  vtkNew<vtkPlane> function;
  function->SetOrigin(plane.origin.x(), plane.origin.y(), plane.origin.z());
  function->SetNormal(plane.normal.x(), plane.normal.y(), plane.normal.z());
  vtkNew<vtkCutter> cutter;
  cutter->SetCutFunction(function);
  cutter->SetInputData(others);
  cutter->GenerateTrianglesOff();
  vtkNew<vtkPolyData> solids;
  solids->ShallowCopy(output);
  vtkNew<vtkAppendPolyData> append;
  if (solids->GetNumberOfCells() > 0) append->AddInputData(solids);
  append->AddInputConnection(cutter->GetOutputPort());
  append->Update();
  output->ShallowCopy(append->GetOutput());
}

}  // namespace

void vtkMeshSlice::Run(vtkInformationVector** inputs, vtkUnstructuredGrid*, vtkPolyData*,
                       pm::Monitor& monitor) {
  vtkDataObject* output = this->GetOutputDataObject(0);
  const pm::SlicePlane plane = planeOf(this->Plane);
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::GetData(inputs[0]);
  if (grid->GetNumberOfCells() == 0 || grid->GetNumberOfPoints() == 0) return;
  if (grid->GetNumberOfPoints() > std::numeric_limits<pm::Id>::max())
    throw pm::InputError("Mesh Slice takes grids of up to 2147483647 points; slice the parts one by one.");

  monitor.check(0.0, "looking for cells");
  const std::vector<double> distance = signedDistances(grid->GetPoints(), plane);
  const std::vector<char> at = cellsAtPlane(grid, distance);
  std::vector<vtkIdType> solids, others;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    if (at[c]) (pm::hasStraightEdges(grid->GetCellType(c)) ? solids : others).push_back(c);
  }

  monitor.check(0.3, "reading cells");
  const pm::FaceRows rows = pm::facesOf(grid, solids, "Mesh Slice");
  const auto position = [&](pm::Id p) {
    pm::Vec3 x;
    grid->GetPoints()->GetPoint(p, x.data());
    return x;
  };
  pm::PartMonitor cutting(monitor, 0.4, 0.8);
  const pm::PlaneSection section = pm::sliceCells(rows.faces, rows.cells, distance, position, plane, cutting);
  std::vector<vtkIdType> cells(section.cell.size());
  std::transform(section.cell.begin(), section.cell.end(), cells.begin(),
                 [&](pm::Id i) { return solids[i]; });

  monitor.check(0.8, "storing the slice");
  if (auto* slice = vtkPolyData::SafeDownCast(output)) {
    fillPoints(section, grid, slice);
    fillPolygons(section, cells, grid, slice);
    if (!others.empty()) appendOthers(grid, others, plane, slice);
  } else {
    cells.insert(cells.end(), others.begin(), others.end());
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    extract(grid, cells, vtkUnstructuredGrid::SafeDownCast(output));
    // No whole mesh of the suite any more, but cells that Mesh Quality Report may measure.
    output->GetFieldData()->RemoveArray("ProjectionMesherStamp");
  }
}

void vtkMeshSlice::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Crinkle: " << this->Crinkle << "\n";
  os << indent << "Plane:\n";
  if (this->Plane) this->Plane->PrintSelf(os, indent.GetNextIndent());
}
