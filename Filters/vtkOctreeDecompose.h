// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkOctreeDecompose
 * @brief stage 1: a balanced octree around the geometry, refined where the geometry needs it
 *
 * Input: triangles (vtkPolyData or a composite of them). Output: one voxel for each leaf, with the cell
 * arrays Level, Cut (1 = a triangle touches the leaf) and Key, and field data from which the next stage
 * rebuilds the octree. Source: thesis sections 3.2-3.4. Lengths are in the units of the geometry, angles in
 * degrees.
 */
#pragma once

#include <memory>

#include "vtkMeshStage.h"

namespace pm {
struct OctreeDecomposeOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkOctreeDecompose : public vtkMeshStage {
 public:
  static vtkOctreeDecompose* New();
  vtkTypeMacro(vtkOctreeDecompose, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The smallest cell is at most this large, length; 0 = 1/50 of the geometry's diagonal. */
  vtkSetClampMacro(FeatureSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FeatureSize, double);
  ///@}
  ///@{
  /** Level of the smallest cells, instead of FeatureSize; -1 = use FeatureSize. */
  vtkSetClampMacro(MaximumLevel, int, -1, 18);
  vtkGetMacro(MaximumLevel, int);
  ///@}
  ///@{
  /** Edge of the largest cells, length; 0 = chosen from the geometry's box. */
  vtkSetClampMacro(BaseSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(BaseSize, double);
  ///@}
  ///@{
  /** Mesh the box DomainBounds; its sides become the patches xmin .. zmax. */
  vtkSetMacro(UseDomain, bool);
  vtkGetMacro(UseDomain, bool);
  vtkBooleanMacro(UseDomain, bool);
  ///@}
  ///@{
  /** xmin, xmax, ymin, ymax, zmin, zmax of the domain, length. */
  vtkSetVector6Macro(DomainBounds, double);
  vtkGetVector6Macro(DomainBounds, double);
  ///@}
  ///@{
  /** Cells of base size around the geometry's own box when no domain is given. */
  vtkSetClampMacro(Margin, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Margin, double);
  ///@}
  ///@{
  /** Largest cell that touches the geometry, length; 0 = no limit but the criteria. */
  vtkSetClampMacro(SurfaceSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(SurfaceSize, double);
  ///@}
  ///@{
  /** Largest cell that touches the named patch, length. */
  void AddPatchSize(const char* patch, double size);
  void ClearPatchSizes();
  int GetNumberOfPatchSizes() const;
  ///@}
  ///@{
  /** Cells that touch the box are at most this large, length. */
  void AddRefineBox(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax,
                    double size);
  void ClearRefineBoxes();
  int GetNumberOfRefineBoxes() const;
  ///@}
  ///@{
  /** Angle between normals within a cell that asks for refinement, degrees (criteria 1, 2). */
  vtkSetClampMacro(NormalAngle, double, 0.0, 180.0);
  vtkGetMacro(NormalAngle, double);
  ///@}
  ///@{
  /** Angle between the planes of two triangles from which their edge is sharp, degrees (criterion 5). */
  vtkSetClampMacro(SharpAngle, double, 0.0, 180.0);
  vtkGetMacro(SharpAngle, double);
  ///@}
  ///@{
  /** Cells on sharp edges, patch interfaces and corners go to the finest level. */
  vtkSetMacro(RefineEdges, bool);
  vtkGetMacro(RefineEdges, bool);
  vtkBooleanMacro(RefineEdges, bool);
  ///@}
  ///@{
  /** Refine where surfaces face each other in one cell or in adjacent cells (criteria 3, 4). */
  vtkSetMacro(Separate, bool);
  vtkGetMacro(Separate, bool);
  vtkBooleanMacro(Separate, bool);
  ///@}
  ///@{
  /** alpha_close of the separating criterion, degrees. */
  vtkSetClampMacro(CloseAngle, double, 0.0, 90.0);
  vtkGetMacro(CloseAngle, double);
  ///@}
  ///@{
  /** Cells of the same level beside a cell that touches the geometry. */
  vtkSetClampMacro(BufferCells, int, 0, 100);
  vtkGetMacro(BufferCells, int);
  ///@}
  ///@{
  /** Cells of one level before the next coarser one begins. */
  vtkSetClampMacro(CellsBetweenLevels, int, 1, 100);
  vtkGetMacro(CellsBetweenLevels, int);
  ///@}
  ///@{
  /** Budget; a larger estimate is an error before memory is spent. */
  vtkSetClampMacro(MaximumCells, vtkIdType, 1, VTK_INT_MAX);
  vtkGetMacro(MaximumCells, vtkIdType);
  ///@}

  /** The properties as the kernel takes them. */
  pm::OctreeDecomposeOptions Options() const;

 protected:
  vtkOctreeDecompose();
  ~vtkOctreeDecompose() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  double FeatureSize;
  int MaximumLevel;
  double BaseSize;
  bool UseDomain;
  double DomainBounds[6] = {0, 1, 0, 1, 0, 1};
  double Margin;
  double SurfaceSize;
  double NormalAngle;
  double SharpAngle;
  bool RefineEdges;
  bool Separate;
  double CloseAngle;
  int BufferCells;
  int CellsBetweenLevels;
  vtkIdType MaximumCells;

 private:
  vtkOctreeDecompose(const vtkOctreeDecompose&) = delete;
  void operator=(const vtkOctreeDecompose&) = delete;

  struct Lists;
  std::unique_ptr<Lists> Repeated;  // patch sizes and boxes
};
