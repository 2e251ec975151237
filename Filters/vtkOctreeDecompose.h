// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkOctreeDecompose
 * @brief stage 1: a balanced octree around the geometry, refined where the geometry needs it
 *
 * Input: triangles (vtkPolyData or a composite of them), and optionally on port 1 a surface that is not
 * meshed but near which cells are small (SurfaceDistances). Output: one voxel for each leaf, with the cell
 * arrays Level, Cut (1 = a triangle touches the leaf), Key, and RefinedBy and RefinedByPatch (why the leaf is
 * as small as it is), and field data from which the next stage rebuilds the octree. Source: thesis
 * sections 3.2-3.4. Lengths are in the units of the geometry, angles in degrees.
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
  /** Cells that touch the sphere are at most this large, length. */
  void AddRefineSphere(double x, double y, double z, double radius, double size);
  void ClearRefineSpheres();
  int GetNumberOfRefineSpheres() const;
  ///@}
  ///@{
  /** Cells that touch the solid cylinder between two points of its axis are at most this large, length. */
  void AddRefineCylinder(double x0, double y0, double z0, double x1, double y1, double z1, double radius,
                         double size);
  void ClearRefineCylinders();
  int GetNumberOfRefineCylinders() const;
  ///@}
  ///@{
  /** Cells within a distance of the named patch are at most this large, lengths. */
  void AddPatchDistance(const char* patch, double distance, double size);
  void ClearPatchDistances();
  int GetNumberOfPatchDistances() const;
  ///@}
  ///@{
  /** Cells within a distance of the surface on input port 1 are at most this large, lengths. */
  void AddSurfaceDistance(double distance, double size);
  void ClearSurfaceDistances();
  int GetNumberOfSurfaceDistances() const;
  ///@}
  ///@{
  /** Free cells across gaps between facing surfaces; 0 = off. */
  vtkSetClampMacro(GapCells, int, 0, 100);
  vtkGetMacro(GapCells, int);
  ///@}
  ///@{
  /** Cells around a circle as curved as the surface; 0 = off. */
  vtkSetClampMacro(CellsPerCircle, int, 0, 1000);
  vtkGetMacro(CellsPerCircle, int);
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
  /** Criterion 1: NormalAngle within a cell. */
  vtkSetMacro(CellNormals, bool);
  vtkGetMacro(CellNormals, bool);
  vtkBooleanMacro(CellNormals, bool);
  ///@}
  ///@{
  /** Criterion 2: NormalAngle between adjacent cells. */
  vtkSetMacro(NeighbourNormals, bool);
  vtkGetMacro(NeighbourNormals, bool);
  vtkBooleanMacro(NeighbourNormals, bool);
  ///@}
  ///@{
  /** Criterion 3: facing surfaces within a cell. */
  vtkSetMacro(CellSeparation, bool);
  vtkGetMacro(CellSeparation, bool);
  vtkBooleanMacro(CellSeparation, bool);
  ///@}
  ///@{
  /** Criterion 4: facing surfaces in adjacent cells. */
  vtkSetMacro(NeighbourSeparation, bool);
  vtkGetMacro(NeighbourSeparation, bool);
  vtkBooleanMacro(NeighbourSeparation, bool);
  ///@}
  ///@{
  /** Criterion 5 for sharp edges. */
  vtkSetMacro(RefineSharp, bool);
  vtkGetMacro(RefineSharp, bool);
  vtkBooleanMacro(RefineSharp, bool);
  ///@}
  ///@{
  /** Criterion 5 for edges between patches. */
  vtkSetMacro(RefineInterfaces, bool);
  vtkGetMacro(RefineInterfaces, bool);
  vtkBooleanMacro(RefineInterfaces, bool);
  ///@}
  enum OpenEdgeType { NONE = 0, SEAMS = 1, ALL = 2 };
  ///@{
  /** Criterion 5 for open edges: none, those close to surface they should be stitched to, or all. */
  vtkSetClampMacro(RefineOpen, int, NONE, ALL);
  vtkGetMacro(RefineOpen, int);
  ///@}
  ///@{
  /** Criterion 5 for corners: ends and joints of critical edges. */
  vtkSetMacro(RefineCorners, bool);
  vtkGetMacro(RefineCorners, bool);
  vtkBooleanMacro(RefineCorners, bool);
  ///@}
  enum FeatureDepthType { AS_NEEDED = 0, FULL = 1 };
  ///@{
  /** How deep cells on critical edges are split: as separating them needs, or to the finest level. */
  vtkSetClampMacro(FeatureDepth, int, AS_NEEDED, FULL);
  vtkGetMacro(FeatureDepth, int);
  ///@}
  ///@{
  /** Criterion 7: cells of the finest size around a critical edge. */
  vtkSetClampMacro(FeatureBuffer, int, 0, 100);
  vtkGetMacro(FeatureBuffer, int);
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
  ///@{
  /** Budget of memory for the whole mesh, GB; a larger estimate is an error; 0 = none. */
  vtkSetClampMacro(MaximumMemory, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MaximumMemory, double);
  ///@}

  /** The properties as the kernel takes them; sizeSurface: what lies on input port 1, if anything. */
  pm::OctreeDecomposeOptions Options(vtkDataObject* sizeSurface = nullptr) const;

 protected:
  vtkOctreeDecompose();
  ~vtkOctreeDecompose() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
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
  bool CellNormals;
  bool NeighbourNormals;
  bool CellSeparation;
  bool NeighbourSeparation;
  bool RefineSharp;
  bool RefineInterfaces;
  int RefineOpen;
  bool RefineCorners;
  int FeatureDepth;
  int FeatureBuffer;
  int BufferCells;
  int CellsBetweenLevels;
  int GapCells;
  int CellsPerCircle;
  vtkIdType MaximumCells;
  double MaximumMemory;

 private:
  vtkOctreeDecompose(const vtkOctreeDecompose&) = delete;
  void operator=(const vtkOctreeDecompose&) = delete;

  struct Lists;
  std::unique_ptr<Lists> Repeated;  // properties of several rows
};
