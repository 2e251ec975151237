// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkFarField
 * @brief extends a mesh from the sides of its domain to a far box or sphere
 *
 * Input: the grid of any stage from vtkPaintFront on, made in a given domain; normally the finished mesh. The
 * output is of the same stage. Source: thesis section 3.3.2, Fig. 3-12.
 */
#pragma once

#include <memory>

#include "vtkValidMeshStage.h"

namespace pm {
struct FarFieldOptions;
struct FarFieldReport;
}  // namespace pm

class PROJECTIONMESHERFILTERS_EXPORT vtkFarField : public vtkValidMeshStage {
 public:
  static vtkFarField* New();
  vtkTypeMacro(vtkFarField, vtkValidMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The far boundary: 0 = box, 1 = sphere, or the part of one that sides which stay cut out. */
  vtkSetClampMacro(Shape, int, 0, 1);
  vtkGetMacro(Shape, int);
  ///@}
  ///@{
  /** Which of the domain's sides are extended; the others stay where they are. */
  vtkSetMacro(ExtendXmin, bool);
  vtkGetMacro(ExtendXmin, bool);
  vtkSetMacro(ExtendXmax, bool);
  vtkGetMacro(ExtendXmax, bool);
  vtkSetMacro(ExtendYmin, bool);
  vtkGetMacro(ExtendYmin, bool);
  vtkSetMacro(ExtendYmax, bool);
  vtkGetMacro(ExtendYmax, bool);
  vtkSetMacro(ExtendZmin, bool);
  vtkGetMacro(ExtendZmin, bool);
  vtkSetMacro(ExtendZmax, bool);
  vtkGetMacro(ExtendZmax, bool);
  ///@}
  ///@{
  /** From the domain to the far boundary, length; 0 = twice the domain's longest edge. */
  vtkSetClampMacro(Distance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Distance, double);
  ///@}
  ///@{
  /** The far box is FarBounds, whatever Distance is. */
  vtkSetMacro(UseBounds, bool);
  vtkGetMacro(UseBounds, bool);
  vtkBooleanMacro(UseBounds, bool);
  ///@}
  ///@{
  /** xmin, xmax, ymin, ymax, zmin, zmax of the far box, length; not read for sides that stay. */
  vtkSetVector6Macro(FarBounds, double);
  vtkGetVector6Macro(FarBounds, double);
  ///@}
  ///@{
  /** Radius of the far sphere, length, instead of Distance; 0 = use Distance. */
  vtkSetClampMacro(Radius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Radius, double);
  ///@}
  ///@{
  /** Most that a far cell is thicker than the one before it. */
  vtkSetClampMacro(ExpansionRatio, double, 1.0, 10.0);
  vtkGetMacro(ExpansionRatio, double);
  ///@}
  ///@{
  /** Most cells in a column. */
  vtkSetClampMacro(MaximumLayers, int, 1, 1000);
  vtkGetMacro(MaximumLayers, int);
  ///@}

  ///@{
  /** What the last run added: cells, their volume, and the cells in the longest columns. */
  vtkIdType GetFarCells() const;
  double GetFarVolume() const;
  int GetFarLayers() const;
  ///@}

  /** The properties as the kernel takes them. */
  pm::FarFieldOptions Options() const;

 protected:
  vtkFarField();
  ~vtkFarField() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Shape;
  bool ExtendXmin, ExtendXmax, ExtendYmin, ExtendYmax, ExtendZmin, ExtendZmax;
  double Distance;
  bool UseBounds;
  double FarBounds[6] = {0, 1, 0, 1, 0, 1};
  double Radius;
  double ExpansionRatio;
  int MaximumLayers;

 private:
  vtkFarField(const vtkFarField&) = delete;
  void operator=(const vtkFarField&) = delete;

  std::unique_ptr<pm::FarFieldReport> Report;
};
