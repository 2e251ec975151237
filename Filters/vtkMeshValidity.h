// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkMeshValidity
 * @brief measures a mesh of the suite and says what in it is outside the validity limits
 *
 * Input: the grid of any stage from vtkPaintFront on. Outputs: the grid with the worst measures of each cell
 * and of its faces as cell arrays (CellVolume, SmallestTet: in finest cells; Degradation, Angle, Warpage,
 * Skewness: worst face), and its boundary faces. The getters hold what the last run found. A mesh with
 * boundary layers is thin on purpose: for it the limits on volume and on degradation ask for positive values
 * only. Source: thesis section 4.3.
 */
#pragma once

#include <memory>
#include <string>

#include "vtkValidMeshStage.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkMeshValidity : public vtkValidMeshStage {
 public:
  static vtkMeshValidity* New();
  vtkTypeMacro(vtkMeshValidity, vtkValidMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Faces and cells outside the limits, and a sentence for each limit that is broken (empty when valid). */
  vtkIdType GetViolations() const;
  const char* GetDescription() const;
  ///@}
  ///@{
  /** Size of the mesh. */
  vtkIdType GetInternalFaces() const;
  vtkIdType GetBoundaryFaces() const;
  double GetTotalVolume() const;
  ///@}
  ///@{
  /** The worst values found; volumes in volumes of the smallest octree cell, angles in degrees. */
  double GetWorstVolume() const;
  double GetWorstTet() const;
  double GetWorstEtaInternal() const;
  double GetWorstEtaBoundary() const;
  double GetWorstAngleInternal() const;
  double GetWorstAngleBoundary() const;
  double GetWorstWarpage() const;
  double GetWorstSkewInternal() const;
  double GetWorstSkewBoundary() const;
  double GetWorstOpenness() const;
  ///@}

 protected:
  vtkMeshValidity();
  ~vtkMeshValidity() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

 private:
  vtkMeshValidity(const vtkMeshValidity&) = delete;
  void operator=(const vtkMeshValidity&) = delete;

  /// Fills the findings and adds the measures to the grid.
  void Measure(const pm::PolyMesh& mesh, vtkUnstructuredGrid* grid);

  struct Findings;
  std::unique_ptr<Findings> Found;
};
