// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPaintFront
 * @brief stage 2: the domain's leaves, and a front that a prism layer can grow on
 *
 * Input 0: the grid of vtkOctreeDecompose; input 1: the geometry it was made from. Outputs: the domain's
 * cells and their boundary faces. The regions found are listed in the field arrays RegionCells, RegionVolume
 * and RegionOpen of output 0, largest first. Source: thesis sections 3.4.2, 3.5.
 */
#pragma once

#include <memory>

#include "vtkMeshStage.h"

namespace pm {
struct PaintFrontOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkPaintFront : public vtkMeshStage {
 public:
  static vtkPaintFront* New();
  vtkTypeMacro(vtkPaintFront, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum RegionType { INSIDE = 0, OUTSIDE = 1, POINTS = 2 };
  ///@{
  /** Which region is meshed: the largest enclosed one, everything outside, or the ones that hold the seed
   * points. */
  vtkSetClampMacro(Region, int, INSIDE, POINTS);
  vtkGetMacro(Region, int);
  void SetRegionToInside() { this->SetRegion(INSIDE); }
  void SetRegionToOutside() { this->SetRegion(OUTSIDE); }
  void SetRegionToPoints() { this->SetRegion(POINTS); }
  ///@}
  ///@{
  /** Points inside the wanted regions, for Region = Points. */
  void AddSeedPoint(double x, double y, double z);
  void ClearSeedPoints();
  int GetNumberOfSeedPoints() const;
  ///@}
  ///@{
  /** Accept a region of seed points that reaches the sides of an undeclared domain. */
  vtkSetMacro(AllowOpen, bool);
  vtkGetMacro(AllowOpen, bool);
  vtkBooleanMacro(AllowOpen, bool);
  ///@}
  ///@{
  /** Fill cells of the front that would leave it hollow (Fig. 3-33). */
  vtkSetMacro(Fill, bool);
  vtkGetMacro(Fill, bool);
  vtkBooleanMacro(Fill, bool);
  ///@}

  /** The properties as the kernel takes them. */
  pm::PaintFrontOptions Options() const;

 protected:
  vtkPaintFront();
  ~vtkPaintFront() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Region;
  bool AllowOpen;
  bool Fill;

 private:
  vtkPaintFront(const vtkPaintFront&) = delete;
  void operator=(const vtkPaintFront&) = delete;

  struct Lists;
  std::unique_ptr<Lists> Repeated;  // seed points
};
