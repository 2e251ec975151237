// SPDX-License-Identifier: BSD-3-Clause
// Arrays and the stamp of packed grids: what MeshPacking and OctreePacking share.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "PolyMesh.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkSetGet.h"

class vtkUnstructuredGrid;

namespace pm {

/// Throws the InputError of a grid that something else has changed; what: "its points have changed".
[[noreturn]] void refuseChanged(const std::string& filter, const std::string& what);

/// "Paint Front" and so on: the filter whose output has this stage.
const char* filterOf(Stage stage);

/// What a grid says about itself; the array is named ProjectionMesherStamp.
struct Stamp {
  Stage stage = Stage::None;
  std::int64_t boundaryFaces = 0;
  std::uint64_t sum = 0;
};
/// Points and cells are counted from the grid itself, so fill it first.
void addStamp(vtkUnstructuredGrid* grid, Stage stage, Id boundaryFaces, std::uint64_t sum);
/// Throws InputError when there is no stamp, its counts are not the grid's, or the stage is none of the
/// accepted (empty = any).
Stamp readStamp(vtkUnstructuredGrid* grid, const std::string& filter, std::initializer_list<Stage> accepted);

void addStrings(vtkFieldData* data, const char* name, const std::vector<std::string>& values);
/// Empty when there is no such array.
std::vector<std::string> readStrings(vtkFieldData* data, const char* name);

/// An array of the class Array with the values; none when there are no values.
template <class Array, class T>
void addArray(vtkFieldData* data, const char* name, const std::vector<T>& values) {
  if (values.empty()) return;
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  data->AddArray(array);
}

/// The values of one kind of all rows, in their order.
template <class T, class Rows, class Value>
std::vector<T> column(const Rows& rows, const Value& value) {
  std::vector<T> values;
  values.reserve(rows.size());
  for (const auto& row : rows) values.push_back(value(row));
  return values;
}

/// The values of an array of any numeric type. An absent array is an empty vector.
template <class T>
std::vector<T> readArray(vtkFieldData* data, const char* name) {
  vtkDataArray* array = data->GetArray(name);
  if (!array || !array->HasStandardMemoryLayout()) return {};
  std::vector<T> values(array->GetNumberOfValues());
  switch (array->GetDataType()) {
    vtkTemplateMacro(std::transform(static_cast<const VTK_TT*>(array->GetVoidPointer(0)),
                                    static_cast<const VTK_TT*>(array->GetVoidPointer(0)) + values.size(),
                                    values.begin(), [](VTK_TT x) { return static_cast<T>(x); }));
  }
  return values;
}

/// The same for an array that must be there with this many values; throws InputError when it is not.
template <class T>
std::vector<T> readArray(vtkFieldData* data, const char* name, vtkIdType size, const std::string& filter) {
  std::vector<T> values = readArray<T>(data, name);
  if (static_cast<vtkIdType>(values.size()) != size) {
    refuseChanged(filter, std::string("the array ") + name + " is missing or has another size");
  }
  return values;
}

}  // namespace pm
