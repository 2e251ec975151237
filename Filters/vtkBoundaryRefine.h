// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkBoundaryRefine
 * @brief stage 6: wall prisms split into boundary layers
 *
 * Input: the grid of vtkResolveFeatures, or of vtkProject where features do not matter. Output ports: the
 * mesh; its boundary, with arrays that say face by face what layers were made; a table with a row for each
 * patch. Source: thesis section 4.8.
 */
#pragma once

#include <memory>
#include <vector>

#include "vtkValidMeshStage.h"

namespace pm {
struct BoundaryRefineOptions;
struct BoundaryRefineReport;
struct PatchLayers;
}  // namespace pm

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
  /** Height of the cell at the wall, length; 0 = from the other properties. */
  vtkSetClampMacro(FirstHeight, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FirstHeight, double);
  ///@}
  ///@{
  /** Height of all layers, length; 0 = from the other properties. */
  vtkSetClampMacro(TotalThickness, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(TotalThickness, double);
  ///@}
  ///@{
  /** y+ of the centre of the cell at the wall, by the flow given; 0 = from the other properties. */
  vtkSetClampMacro(YPlus, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(YPlus, double);
  ///@}
  ///@{
  /** The flow that YPlus is for: speed, length of the wall along it, kinematic viscosity. */
  vtkSetClampMacro(FlowSpeed, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FlowSpeed, double);
  vtkSetClampMacro(FlowLength, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FlowLength, double);
  vtkSetClampMacro(KinematicViscosity, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(KinematicViscosity, double);
  ///@}
  ///@{
  /** Layers on patches of their own: a name with * and ?, layers (0 = none), expansion ratio, and first
   * height, thickness and y+ as above. The last that fits a patch counts. */
  void AddPatchLayer(const char* patches, int layers, double expansionRatio, double firstHeight,
                     double totalThickness, double yPlus);
  void ClearPatchLayers();
  int GetNumberOfPatchLayers() const;
  ///@}
  ///@{
  /** Whether prisms and the cells behind them are divided anew, so that heights grow evenly into the volume;
   * else prisms stay as high as they are, and the last layer takes what is left. */
  vtkSetMacro(EvenGrowth, bool);
  vtkGetMacro(EvenGrowth, bool);
  vtkBooleanMacro(EvenGrowth, bool);
  ///@}
  ///@{
  /** Whether points inside may move to make room for layers. */
  vtkSetMacro(MakeRoom, bool);
  vtkGetMacro(MakeRoom, bool);
  vtkBooleanMacro(MakeRoom, bool);
  ///@}

  ///@{
  /** What the last run reached: wall faces, and how many of them have the given number of layers (1, 2, ..).
   */
  vtkIdType GetWallFaces() const;
  vtkIdType GetFacesWithLayers(int layers) const;
  ///@}

  /** The output port with a row for each patch: layers, heights, and reasons for fewer. */
  enum LayersPort { LAYERS = 2 };

  /** The properties as the kernel takes them. */
  pm::BoundaryRefineOptions Options() const;

 protected:
  vtkBoundaryRefine();
  ~vtkBoundaryRefine() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Layers;
  double ExpansionRatio;
  double FirstHeight;
  double TotalThickness;
  double YPlus;
  double FlowSpeed;
  double FlowLength;
  double KinematicViscosity;
  bool EvenGrowth;
  bool MakeRoom;

 private:
  vtkBoundaryRefine(const vtkBoundaryRefine&) = delete;
  void operator=(const vtkBoundaryRefine&) = delete;

  std::vector<pm::PatchLayers> PatchLayers;
  std::unique_ptr<pm::BoundaryRefineReport> Report;
};
