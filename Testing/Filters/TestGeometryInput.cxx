// SPDX-License-Identifier: BSD-3-Clause
// The triangles that filters share: one model for unchanged data and for equal content, as long as it is
// held.
#include "GeometryInput.h"

#include <gtest/gtest.h>

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

namespace {

/// Two triangles over a square, in patches by the arrays PatchId (one) and Other (two).
vtkSmartPointer<vtkPolyData> square(double edge = 1) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int i = 0; i < 4; ++i) points->InsertNextPoint(i % 2 ? edge : 0, i / 2 ? edge : 0, 0);
  vtkNew<vtkCellArray> polys;
  const vtkIdType triangles[2][3] = {{0, 1, 2}, {1, 3, 2}};
  for (const auto& t : triangles) polys->InsertNextCell(3, t);
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(polys);
  for (const char* name : {"PatchId", "Other"}) {
    vtkNew<vtkIntArray> ids;
    ids->SetName(name);
    ids->InsertNextValue(0);
    ids->InsertNextValue(name[0] == 'O');
    surface->GetCellData()->AddArray(ids);
  }
  return surface;
}

TEST(GeometryInput, UnchangedDataGivesTheSameModel) {
  const auto data = square();
  const auto first = pm::surfaceFrom(data, nullptr);
  EXPECT_EQ(pm::surfaceFrom(data, nullptr), first);
  EXPECT_EQ(pm::surfaceFrom(data, ""), first);
  EXPECT_EQ(first->triangleCount(), 2);
}

TEST(GeometryInput, EqualContentGivesTheSameModel) {
  const auto first = pm::surfaceFrom(square(), nullptr);
  EXPECT_EQ(pm::surfaceFrom(square(), nullptr), first);
  EXPECT_NE(pm::surfaceFrom(square(2), nullptr), first);
}

TEST(GeometryInput, ChangedDataGivesAnother) {
  const auto data = square();
  const auto first = pm::surfaceFrom(data, nullptr);
  data->GetPoints()->SetPoint(3, 5, 5, 0);
  data->GetPoints()->Modified();
  const auto moved = pm::surfaceFrom(data, nullptr);
  EXPECT_NE(moved, first);
  EXPECT_EQ(moved->bounds().hi, pm::Vec3(5, 5, 0));
  EXPECT_EQ(first->bounds().hi, pm::Vec3(1, 1, 0));
  const vtkIdType turned[] = {1, 2, 3};
  data->GetPolys()->ReplaceCellAtId(1, 3, turned);
  data->GetPolys()->Modified();
  EXPECT_NE(pm::surfaceFrom(data, nullptr), moved);
}

TEST(GeometryInput, AnotherPatchArrayGivesAnother) {
  const auto data = square();
  const auto one = pm::surfaceFrom(data, nullptr), two = pm::surfaceFrom(data, "Other");
  EXPECT_EQ(one->patchNames().size(), 1u);
  EXPECT_EQ(two->patchNames().size(), 2u);
  data->GetCellData()->GetArray("Other")->SetTuple1(1, 0);
  data->GetCellData()->GetArray("Other")->Modified();
  EXPECT_EQ(pm::surfaceFrom(data, "Other")->patchNames().size(), 1u);
}

TEST(GeometryInput, NamesOfBlocksCount) {
  const auto data = square(), other = square(3);
  const auto blocks = [&](const char* name) {
    auto group = vtkSmartPointer<vtkMultiBlockDataSet>::New();
    group->SetBlock(0, data);
    group->SetBlock(1, other);
    group->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), name);
    return group;
  };
  const auto first = pm::surfaceFrom(blocks("inlet"), nullptr);
  EXPECT_EQ(pm::surfaceFrom(blocks("inlet"), nullptr), first);
  EXPECT_NE(pm::surfaceFrom(blocks("outlet"), nullptr), first);
  EXPECT_EQ(first->patchNames()[0], "inlet");
}

TEST(GeometryInput, AModelNobodyHoldsIsReleased) {
  const auto data = square();
  std::weak_ptr<const pm::SurfaceModel> released = pm::surfaceFrom(data, nullptr);
  EXPECT_TRUE(released.expired());
  const auto again = pm::surfaceFrom(data, nullptr);
  EXPECT_EQ(again->triangleCount(), 2);
}

TEST(GeometryInput, NothingToMeshIsAnError) {
  vtkNew<vtkPolyData> empty;
  EXPECT_THROW(pm::surfaceFrom(empty, nullptr), pm::InputError);
}

}  // namespace
