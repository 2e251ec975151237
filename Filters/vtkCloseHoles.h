// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkCloseHoles
 * @brief finds where the octree of a geometry would leak, and closes those holes
 *
 * Input: triangles (vtkPolyData or a composite of them). The octree's properties are those of
 * vtkOctreeDecompose: a hole is what that octree leaks through. Outputs: 0 the geometry as vtkPolyData with
 * PatchId and PatchNames, with the patch closed_holes where holes were closed; 1 the leak paths; 2 a membrane
 * in each hole; 3 a table of the holes. The widest hole is number 0 everywhere. Source: thesis section 3.6.
 * Lengths are in the units of the geometry.
 */
#pragma once

#include <memory>

#include "vtkOctreeDecompose.h"

namespace pm {
struct CloseHolesOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkCloseHoles : public vtkOctreeDecompose {
 public:
  static vtkCloseHoles* New();
  vtkTypeMacro(vtkCloseHoles, vtkOctreeDecompose);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum MethodType { SHOW_ONLY = 0, COARSE_TO_FINE = 1, OFFSET = 2 };
  ///@{
  /** Show Only finds holes; Coarse To Fine puts a membrane in each; Offset covers each from behind. */
  vtkSetClampMacro(Method, int, SHOW_ONLY, OFFSET);
  vtkGetMacro(Method, int);
  ///@}
  ///@{
  /** Holes wider than this stay open, length; 0 = all are closed. */
  vtkSetClampMacro(MaximumWidth, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MaximumWidth, double);
  ///@}
  ///@{
  /** Points in rooms that are meant to be inside; none = rooms are found. */
  void AddInsidePoint(double x, double y, double z);
  void ClearInsidePoints();
  int GetNumberOfInsidePoints() const;
  ///@}
  ///@{
  /** Points that are outside; none = the corners of the octree. */
  void AddOutsidePoint(double x, double y, double z);
  void ClearOutsidePoints();
  int GetNumberOfOutsidePoints() const;
  ///@}
  ///@{
  /** A found room is at least this many times as wide as its widest way out. */
  vtkSetClampMacro(Roominess, double, 1.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Roominess, double);
  ///@}
  ///@{
  /** A found room has at least this part of the volume of the geometry's box. */
  vtkSetClampMacro(SmallestRoom, double, 0.0, 1.0);
  vtkGetMacro(SmallestRoom, double);
  ///@}

  /** The properties as the kernel takes them; the octree's are in Options(). */
  pm::CloseHolesOptions HoleOptions() const;

 protected:
  vtkCloseHoles();
  ~vtkCloseHoles() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Method;
  double MaximumWidth;
  double Roominess;
  double SmallestRoom;

 private:
  vtkCloseHoles(const vtkCloseHoles&) = delete;
  void operator=(const vtkCloseHoles&) = delete;

  struct GivenPoints;
  std::unique_ptr<GivenPoints> Given;
};
