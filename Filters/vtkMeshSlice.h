// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkMeshSlice
 * @brief cross-section of a grid of any cells, complete and quick where it holds polyhedra
 *
 * Input: any vtkUnstructuredGrid. Output: vtkPolyData, for each cell the plane cuts one polygon, of as many
 * corners as the plane meets edges of the cell, so that a picture's mesh lines are the cells'; or, with
 * Crinkle on, a vtkUnstructuredGrid of those cells as they are. Point data are interpolated, cell data
 * carried; the cell array vtkOriginalCellIds says which cell of the input it is.
 *
 * Solid cells with straight edges are cut by the kernel (MeshSlice.h), all others (surfaces, lines, cells of
 * higher order) by vtkCutter. Neither ever sees a cell that the plane does not touch.
 */
#pragma once

#include "vtkMeshStage.h"
#include "vtkPlane.h"
#include "vtkSmartPointer.h"

class vtkDataSet;

class PROJECTIONMESHERFILTERS_EXPORT vtkMeshSlice : public vtkMeshStage {
 public:
  static vtkMeshSlice* New();
  vtkTypeMacro(vtkMeshSlice, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The plane; the default is z = 0. */
  virtual void SetPlane(vtkPlane* plane);
  vtkPlane* GetPlane() const { return this->Plane; }
  ///@}
  ///@{
  /** The cells that the plane cuts, whole, instead of their polygons. */
  vtkSetMacro(Crinkle, bool);
  vtkGetMacro(Crinkle, bool);
  vtkBooleanMacro(Crinkle, bool);
  ///@}

  /** vtkPolyData, or with Crinkle vtkUnstructuredGrid. */
  vtkDataSet* GetOutput();

  vtkMTimeType GetMTime() override;
  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                             vtkInformationVector* outputs) override;

 protected:
  vtkMeshSlice();
  ~vtkMeshSlice() override = default;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  vtkSmartPointer<vtkPlane> Plane;
  bool Crinkle = false;

 private:
  vtkMeshSlice(const vtkMeshSlice&) = delete;
  void operator=(const vtkMeshSlice&) = delete;
};
