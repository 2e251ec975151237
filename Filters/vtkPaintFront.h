// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPaintFront
 * @brief stage 2: the domain's leaves, and a front that a prism layer can grow on
 *
 * Input 0: the grid of vtkOctreeDecompose; input 1: the geometry it was made from. Outputs: the domain's
 * cells and their boundary faces; a table of the regions found, largest first (see RegionPacking.h for its
 * columns), and points in what is too narrow for the cells. Several regions are zones of the mesh. When a
 * region leaks there is an error, and output 4 alone holds something: the leak paths (see LeakPacking.h).
 * There are also the ways into rooms that the mesh reaches only through openings a few cells wide.
 * Source: thesis sections 3.4.2, 3.5, 3.6.3.
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

  /** Output ports after Mesh and Boundary. */
  enum PortType { REGIONS = 2, INVISIBLE = 3, LEAKS = 4 };

  enum RegionType { INSIDE = 0, OUTSIDE = 1, POINTS = 2, ENCLOSED = 3, EVERYTHING = 4, IDS = 5, PATCHES = 6 };
  ///@{
  /** Which regions are meshed: the largest enclosed one, everything outside, the ones that hold the seed
   * points, all enclosed ones, all, the ones of the given ids, or the enclosed ones that touch a given patch.
   */
  vtkSetClampMacro(Region, int, INSIDE, PATCHES);
  vtkGetMacro(Region, int);
  void SetRegionToInside() { this->SetRegion(INSIDE); }
  void SetRegionToOutside() { this->SetRegion(OUTSIDE); }
  void SetRegionToPoints() { this->SetRegion(POINTS); }
  void SetRegionToEnclosed() { this->SetRegion(ENCLOSED); }
  void SetRegionToEverything() { this->SetRegion(EVERYTHING); }
  void SetRegionToIds() { this->SetRegion(IDS); }
  void SetRegionToPatches() { this->SetRegion(PATCHES); }
  ///@}
  ///@{
  /** Points inside the wanted regions, for Region = Points. */
  void AddSeedPoint(double x, double y, double z);
  void ClearSeedPoints();
  int GetNumberOfSeedPoints() const;
  ///@}
  ///@{
  /** Points that must not be meshed: a region that holds one leaks, which is an error. */
  void AddKeepOutPoint(double x, double y, double z);
  void ClearKeepOutPoints();
  int GetNumberOfKeepOutPoints() const;
  ///@}
  ///@{
  /** Ids of the wanted regions, as in the table of regions, for Region = Ids. */
  void AddRegionId(int id);
  void ClearRegionIds();
  int GetNumberOfRegionIds() const;
  ///@}
  ///@{
  /** Names of patches that the wanted regions touch, for Region = Patches. */
  void AddRegionPatch(const char* name);
  void ClearRegionPatches();
  int GetNumberOfRegionPatches() const;
  ///@}
  ///@{
  /** Accept a region given by points or ids that reaches the sides of an undeclared domain. */
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

  ///@{
  /** Look for parts of the domain that are too narrow for the cells, and show them on output port INVISIBLE.
   */
  vtkSetMacro(ReportInvisible, bool);
  vtkGetMacro(ReportInvisible, bool);
  vtkBooleanMacro(ReportInvisible, bool);
  ///@}

  ///@{
  /** Warn of rooms that the mesh reaches only through openings a few cells wide, and show the ways into them
   * on output port LEAKS. */
  vtkSetMacro(ReportLeaks, bool);
  vtkGetMacro(ReportLeaks, bool);
  vtkBooleanMacro(ReportLeaks, bool);
  ///@}

  /** The properties as the kernel takes them. */
  pm::PaintFrontOptions Options() const;

 protected:
  vtkPaintFront();
  ~vtkPaintFront() override;
  void ShowFailure() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Region;
  bool AllowOpen;
  bool Fill;
  bool ReportInvisible;
  bool ReportLeaks;

 private:
  vtkPaintFront(const vtkPaintFront&) = delete;
  void operator=(const vtkPaintFront&) = delete;

  struct Lists;
  std::unique_ptr<Lists> Repeated;  // seed points, ids, patches
};
