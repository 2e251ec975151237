// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkProjectionMesh
 * @brief the six stages in one filter: geometry in, final mesh out
 *
 * The same kernel calls as vtkOctreeDecompose .. vtkBoundaryRefine in a row, without a grid between them; the
 * result is equal to theirs bit for bit. Properties mean what they mean there; see those classes. Where two
 * stages have an option of the same name, SharpAngle serves both and the rounds have names of their own.
 */
#pragma once

#include <memory>

#include "vtkBoundaryRefine.h"
#include "vtkDummyLayer.h"
#include "vtkNew.h"
#include "vtkOctreeDecompose.h"
#include "vtkPaintFront.h"
#include "vtkProject.h"
#include "vtkResolveFeatures.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkProjectionMesh : public vtkFoamLimitsStage {
 public:
  static vtkProjectionMesh* New();
  vtkTypeMacro(vtkProjectionMesh, vtkFoamLimitsStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkMTimeType GetMTime() override;

/// A property that a stage's own class keeps.
#define pmStageProperty(stage, name, type)                              \
  virtual void Set##name(type value) { this->stage->Set##name(value); } \
  virtual type Get##name() { return this->stage->Get##name(); }

  ///@{
  /** Stage 1, see vtkOctreeDecompose. */
  pmStageProperty(Octree, FeatureSize, double);
  pmStageProperty(Octree, MaximumLevel, int);
  pmStageProperty(Octree, BaseSize, double);
  pmStageProperty(Octree, UseDomain, bool);
  virtual void SetDomainBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax) {
    this->Octree->SetDomainBounds(xmin, xmax, ymin, ymax, zmin, zmax);
  }
  virtual double* GetDomainBounds() VTK_SIZEHINT(6) { return this->Octree->GetDomainBounds(); }
  pmStageProperty(Octree, Margin, double);
  pmStageProperty(Octree, SurfaceSize, double);
  void AddPatchSize(const char* patch, double size) { this->Octree->AddPatchSize(patch, size); }
  void ClearPatchSizes() { this->Octree->ClearPatchSizes(); }
  int GetNumberOfPatchSizes() const { return this->Octree->GetNumberOfPatchSizes(); }
  void AddRefineBox(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax,
                    double size) {
    this->Octree->AddRefineBox(xmin, xmax, ymin, ymax, zmin, zmax, size);
  }
  void ClearRefineBoxes() { this->Octree->ClearRefineBoxes(); }
  int GetNumberOfRefineBoxes() const { return this->Octree->GetNumberOfRefineBoxes(); }
  pmStageProperty(Octree, NormalAngle, double);
  pmStageProperty(Octree, RefineEdges, bool);
  pmStageProperty(Octree, Separate, bool);
  pmStageProperty(Octree, CloseAngle, double);
  pmStageProperty(Octree, BufferCells, int);
  pmStageProperty(Octree, CellsBetweenLevels, int);
  pmStageProperty(Octree, MaximumCells, vtkIdType);
  pmStageProperty(Octree, CellNormals, bool);
  pmStageProperty(Octree, NeighbourNormals, bool);
  pmStageProperty(Octree, CellSeparation, bool);
  pmStageProperty(Octree, NeighbourSeparation, bool);
  pmStageProperty(Octree, RefineSharp, bool);
  pmStageProperty(Octree, RefineInterfaces, bool);
  pmStageProperty(Octree, RefineOpen, int);
  pmStageProperty(Octree, RefineCorners, bool);
  pmStageProperty(Octree, FeatureDepth, int);
  pmStageProperty(Octree, FeatureBuffer, int);
  pmStageProperty(Octree, GapCells, int);
  pmStageProperty(Octree, CellsPerCircle, int);
  pmStageProperty(Octree, MaximumMemory, double);
  void AddRefineSphere(double x, double y, double z, double radius, double size) {
    this->Octree->AddRefineSphere(x, y, z, radius, size);
  }
  void ClearRefineSpheres() { this->Octree->ClearRefineSpheres(); }
  int GetNumberOfRefineSpheres() const { return this->Octree->GetNumberOfRefineSpheres(); }
  void AddRefineCylinder(double x0, double y0, double z0, double x1, double y1, double z1, double radius,
                         double size) {
    this->Octree->AddRefineCylinder(x0, y0, z0, x1, y1, z1, radius, size);
  }
  void ClearRefineCylinders() { this->Octree->ClearRefineCylinders(); }
  int GetNumberOfRefineCylinders() const { return this->Octree->GetNumberOfRefineCylinders(); }
  void AddPatchDistance(const char* patch, double distance, double size) {
    this->Octree->AddPatchDistance(patch, distance, size);
  }
  void ClearPatchDistances() { this->Octree->ClearPatchDistances(); }
  int GetNumberOfPatchDistances() const { return this->Octree->GetNumberOfPatchDistances(); }
  void AddSurfaceDistance(double distance, double size) { this->Octree->AddSurfaceDistance(distance, size); }
  void ClearSurfaceDistances() { this->Octree->ClearSurfaceDistances(); }
  int GetNumberOfSurfaceDistances() const { return this->Octree->GetNumberOfSurfaceDistances(); }
  ///@}

  ///@{
  /** Stages 1 and 5: from which angle an edge is sharp, degrees. */
  virtual void SetSharpAngle(double degrees) {
    this->Octree->SetSharpAngle(degrees);
    this->Features->SetSharpAngle(degrees);
  }
  virtual double GetSharpAngle() { return this->Features->GetSharpAngle(); }
  ///@}

  ///@{
  /** Stage 2, see vtkPaintFront. */
  pmStageProperty(Front, Region, int);
  void AddSeedPoint(double x, double y, double z) { this->Front->AddSeedPoint(x, y, z); }
  void ClearSeedPoints() { this->Front->ClearSeedPoints(); }
  int GetNumberOfSeedPoints() const { return this->Front->GetNumberOfSeedPoints(); }
  void AddKeepOutPoint(double x, double y, double z) { this->Front->AddKeepOutPoint(x, y, z); }
  void ClearKeepOutPoints() { this->Front->ClearKeepOutPoints(); }
  int GetNumberOfKeepOutPoints() const { return this->Front->GetNumberOfKeepOutPoints(); }
  void AddRegionId(int id) { this->Front->AddRegionId(id); }
  void ClearRegionIds() { this->Front->ClearRegionIds(); }
  int GetNumberOfRegionIds() const { return this->Front->GetNumberOfRegionIds(); }
  void AddRegionPatch(const char* name) { this->Front->AddRegionPatch(name); }
  void ClearRegionPatches() { this->Front->ClearRegionPatches(); }
  int GetNumberOfRegionPatches() const { return this->Front->GetNumberOfRegionPatches(); }
  pmStageProperty(Front, AllowOpen, bool);
  pmStageProperty(Front, Fill, bool);
  pmStageProperty(Front, ReportInvisible, bool);
  pmStageProperty(Front, ReportLeaks, bool);
  ///@}

  ///@{
  /** Stage 3, see vtkDummyLayer. */
  pmStageProperty(Layer, Thickness, double);
  ///@}

  ///@{
  /** Stage 4, see vtkProject. */
  virtual void SetProjectionRounds(int rounds) { this->Projection->SetRounds(rounds); }
  virtual int GetProjectionRounds() { return this->Projection->GetRounds(); }
  ///@}

  ///@{
  /** Stage 5, see vtkResolveFeatures. */
  pmStageProperty(Features, CornerAngle, double);
  pmStageProperty(Features, Interfaces, bool);
  pmStageProperty(Features, OpenEdges, bool);
  pmStageProperty(Features, Intersections, bool);
  pmStageProperty(Features, GapTolerance, double);
  pmStageProperty(Features, ShortestCurve, double);
  virtual void SetFeatureRounds(int rounds) { this->Features->SetRounds(rounds); }
  virtual int GetFeatureRounds() { return this->Features->GetRounds(); }
  ///@}

  ///@{
  /** Stage 6, see vtkBoundaryRefine. */
  pmStageProperty(Refine, Layers, int);
  pmStageProperty(Refine, ExpansionRatio, double);
  pmStageProperty(Refine, FirstHeight, double);
  pmStageProperty(Refine, TotalThickness, double);
  pmStageProperty(Refine, YPlus, double);
  pmStageProperty(Refine, FlowSpeed, double);
  pmStageProperty(Refine, FlowLength, double);
  pmStageProperty(Refine, KinematicViscosity, double);
  pmStageProperty(Refine, EvenGrowth, bool);
  pmStageProperty(Refine, MakeRoom, bool);
  void AddPatchLayer(const char* patches, int layers, double expansionRatio, double firstHeight,
                     double totalThickness, double yPlus) {
    this->Refine->AddPatchLayer(patches, layers, expansionRatio, firstHeight, totalThickness, yPlus);
  }
  void ClearPatchLayers() { this->Refine->ClearPatchLayers(); }
  int GetNumberOfPatchLayers() const { return this->Refine->GetNumberOfPatchLayers(); }
  ///@}

  enum CloseHolesType { NOT = 0, COARSE_TO_FINE = 1, OFFSET = 2 };
  ///@{
  /** How holes are closed before stage 1, see vtkCloseHoles. */
  vtkSetClampMacro(CloseHoles, int, NOT, OFFSET);
  vtkGetMacro(CloseHoles, int);
  ///@}

  enum StageType { FRONT = 2, LAYER = 3, PROJECTED = 4, RESOLVED = 5, REFINED = 6 };
  ///@{
  /** The last stage to run. */
  vtkSetClampMacro(StopAfter, int, FRONT, REFINED);
  vtkGetMacro(StopAfter, int);
  ///@}

  ///@{
  /** What the last run made: boundary faces of each patch, resolved features, wall faces by layers made. */
  int GetNumberOfPatches() const;
  const char* GetPatchName(int patch) const;
  vtkIdType GetPatchFaces(int patch) const;
  double GetFeatureLength() const;
  double GetResolvedLength() const;
  vtkIdType GetCorners() const;
  vtkIdType GetResolvedCorners() const;
  vtkIdType GetWallFaces() const;
  vtkIdType GetFacesWithLayers(int layers) const;
  ///@}

  /** Output ports: mesh, boundary, those of vtkPaintFront, vtkResolveFeatures' unresolved features, and
   * vtkBoundaryRefine's table of layers. */
  enum PortType { UNRESOLVED = vtkPaintFront::LEAKS + 1, LAYERS };

 protected:
  vtkProjectionMesh();
  ~vtkProjectionMesh() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void ShowFailure() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int CloseHoles;
  int StopAfter;
  vtkNew<vtkOctreeDecompose> Octree;
  vtkNew<vtkPaintFront> Front;
  vtkNew<vtkDummyLayer> Layer;
  vtkNew<vtkProject> Projection;
  vtkNew<vtkResolveFeatures> Features;
  vtkNew<vtkBoundaryRefine> Refine;

 private:
  vtkProjectionMesh(const vtkProjectionMesh&) = delete;
  void operator=(const vtkProjectionMesh&) = delete;

  struct LastRun;
  std::unique_ptr<LastRun> Report;
};
