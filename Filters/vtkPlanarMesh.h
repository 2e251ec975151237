// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPlanarMesh
 * @brief the section of a finished mesh as a mesh one cell thick, for two-dimensional flow
 *
 * Input: the grid of any stage from vtkPaintFront on, normally the finished mesh. Its section by a plane
 * square to an axis becomes prisms between two patches of type "empty". Source: thesis section 5.5.
 */
#pragma once

#include <memory>

#include "vtkMeshStage.h"

namespace pm {
struct PlanarMeshReport;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkPlanarMesh : public vtkMeshStage {
 public:
  static vtkPlanarMesh* New();
  vtkTypeMacro(vtkPlanarMesh, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The axis that the plane is square to: 0 = x, 1 = y, 2 = z. */
  vtkSetClampMacro(Axis, int, 0, 2);
  vtkGetMacro(Axis, int);
  ///@}
  ///@{
  /** Where the plane is on that axis, length. */
  vtkSetMacro(Position, double);
  vtkGetMacro(Position, double);
  ///@}
  ///@{
  /** Of the mesh, length; 0 = the edge of the smallest octree cell. */
  vtkSetClampMacro(Thickness, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Thickness, double);
  ///@}

  ///@{
  /** What the last run made: the area of the section, and points of the input moved onto the plane. */
  double GetArea() const;
  vtkIdType GetDrawnTogether() const;
  ///@}

 protected:
  vtkPlanarMesh();
  ~vtkPlanarMesh() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Axis;
  double Position;
  double Thickness;

 private:
  vtkPlanarMesh(const vtkPlanarMesh&) = delete;
  void operator=(const vtkPlanarMesh&) = delete;

  std::unique_ptr<pm::PlanarMeshReport> Report;
};
