// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkBoundaryRefine
 * @brief stage 6: wall prisms split into boundary layers
 *
 * Input: the grid of vtkResolveFeatures, or of vtkProject where features do not matter. Source: thesis
 * section 4.8.
 */
#pragma once

#include <vector>

#include "vtkValidMeshStage.h"

namespace pm {
struct BoundaryRefineOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkBoundaryRefine : public vtkValidMeshStage {
 public:
  static vtkBoundaryRefine* New();
  vtkTypeMacro(vtkBoundaryRefine, vtkValidMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Cells across the layer. */
  vtkSetClampMacro(Layers, int, 1, 100);
  vtkGetMacro(Layers, int);
  ///@}
  ///@{
  /** Height of a layer over the height of the one nearer the wall. */
  vtkSetClampMacro(ExpansionRatio, double, 0.1, 10.0);
  vtkGetMacro(ExpansionRatio, double);
  ///@}
  ///@{
  /** Height of the cell at the wall, length; 0 = from Layers and ExpansionRatio. */
  vtkSetClampMacro(FirstHeight, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FirstHeight, double);
  ///@}

  ///@{
  /** What the last run reached: wall faces, and how many of them have the given number of layers (1, 2, ..).
   */
  vtkGetMacro(WallFaces, vtkIdType);
  vtkIdType GetFacesWithLayers(int layers) const;
  ///@}

  /** The properties as the kernel takes them. */
  pm::BoundaryRefineOptions Options() const;

 protected:
  vtkBoundaryRefine();
  ~vtkBoundaryRefine() override = default;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Layers;
  double ExpansionRatio;
  double FirstHeight;
  vtkIdType WallFaces = 0;

 private:
  vtkBoundaryRefine(const vtkBoundaryRefine&) = delete;
  void operator=(const vtkBoundaryRefine&) = delete;

  std::vector<vtkIdType> FacesByLayers;
};
