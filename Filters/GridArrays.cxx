// SPDX-License-Identifier: BSD-3-Clause
#include "GridArrays.h"

#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

constexpr const char* kStampName = "ProjectionMesherStamp";
constexpr std::int64_t kFormat = 1;
enum StampField {
  kStampFormat,
  kStampStage,
  kStampPoints,
  kStampCells,
  kStampBoundary,
  kStampSum,
  kStampSize
};

void checkStage(Stage stage, const std::string& filter, std::initializer_list<Stage> accepted) {
  if (accepted.size() == 0 || std::find(accepted.begin(), accepted.end(), stage) != accepted.end()) return;
  throw InputError(
      filter + " needs the output of " + filterOf(*accepted.begin()) + ", but this grid is the output of " +
      filterOf(stage) +
      "; apply the filters in the order Octree Decompose, Paint Front, Dummy Layer, Project, Resolve "
      "Features, Boundary Refine.");
}

}  // namespace

void refuseChanged(const std::string& filter, const std::string& what) {
  throw InputError(
      filter + ": the input grid is not as the suite made it: " + what +
      ". Apply this filter to the unchanged output of the stage before it; slice, clip and threshold "
      "are for looking only.");
}

const char* filterOf(Stage stage) {
  switch (stage) {
    case Stage::None:
      break;
    case Stage::Octree:
      return "Octree Decompose";
    case Stage::Front:
      return "Paint Front";
    case Stage::Layer:
      return "Dummy Layer";
    case Stage::Projected:
      return "Project";
    case Stage::Resolved:
      return "Resolve Features";
    case Stage::Refined:
      return "Boundary Refine";
  }
  return "another filter";
}

void addStamp(vtkUnstructuredGrid* grid, Stage stage, Id boundaryFaces, std::uint64_t sum) {
  std::vector<std::int64_t> stamp(kStampSize);
  stamp[kStampFormat] = kFormat;
  stamp[kStampStage] = static_cast<std::int64_t>(stage);
  stamp[kStampPoints] = grid->GetNumberOfPoints();
  stamp[kStampCells] = grid->GetNumberOfCells();
  stamp[kStampBoundary] = boundaryFaces;
  stamp[kStampSum] = static_cast<std::int64_t>(sum);
  addArray<vtkTypeInt64Array>(grid->GetFieldData(), kStampName, stamp);
}

Stamp readStamp(vtkUnstructuredGrid* grid, const std::string& filter, std::initializer_list<Stage> accepted) {
  const std::vector<std::int64_t> values = readArray<std::int64_t>(grid->GetFieldData(), kStampName);
  if (values.size() != kStampSize) {
    throw InputError(
        filter +
        " needs a grid made by a filter of this suite; this one carries no stamp of it. Start with "
        "Octree Decompose.");
  }
  if (values[kStampFormat] != kFormat) {
    throw InputError(filter + ": the grid was saved by another version of this suite; make it again.");
  }
  Stamp stamp;
  stamp.stage = static_cast<Stage>(values[kStampStage]);
  stamp.boundaryFaces = values[kStampBoundary];
  stamp.sum = static_cast<std::uint64_t>(values[kStampSum]);
  checkStage(stamp.stage, filter, accepted);
  if (grid->GetNumberOfPoints() != values[kStampPoints]) refuseChanged(filter, "its points have changed");
  if (grid->GetNumberOfCells() != values[kStampCells]) refuseChanged(filter, "its cells have changed");
  return stamp;
}

void addStrings(vtkFieldData* data, const char* name, const std::vector<std::string>& values) {
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) array->SetValue(static_cast<vtkIdType>(i), values[i]);
  data->AddArray(array);
}

std::vector<std::string> readStrings(vtkFieldData* data, const char* name) {
  auto* array = vtkStringArray::SafeDownCast(data->GetAbstractArray(name));
  std::vector<std::string> values;
  for (vtkIdType i = 0; array && i < array->GetNumberOfValues(); ++i) values.push_back(array->GetValue(i));
  return values;
}

}  // namespace pm
