// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkDummyLayer
 * @brief stage 3: one valid prismatic cell on each front face
 *
 * Input: the grid of vtkPaintFront. Source: thesis section 4.2.3, eqs 4-1, 4-2.
 */
#pragma once

#include "vtkFoamLimitsStage.h"

namespace pm {
struct DummyLayerOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkDummyLayer : public vtkFoamLimitsStage {
 public:
  static vtkDummyLayer* New();
  vtkTypeMacro(vtkDummyLayer, vtkFoamLimitsStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Height of the prisms over the size of the cells beside them (eq 4-2). */
  vtkSetClampMacro(Thickness, double, 0.001, 1.0);
  vtkGetMacro(Thickness, double);
  ///@}

  /** The properties as the kernel takes them. */
  pm::DummyLayerOptions Options() const;

 protected:
  vtkDummyLayer();
  ~vtkDummyLayer() override = default;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  double Thickness;

 private:
  vtkDummyLayer(const vtkDummyLayer&) = delete;
  void operator=(const vtkDummyLayer&) = delete;
};
