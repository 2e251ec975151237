// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkProject
 * @brief stage 4: wall nodes drift onto the geometry, valid at every move
 *
 * Input 0: the grid of vtkDummyLayer; input 1: the geometry. Source: thesis sections 4.4.1, 4.5, 4.6.2.
 */
#pragma once

#include "vtkFoamLimitsStage.h"

namespace pm {
struct ProjectOptions;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkProject : public vtkFoamLimitsStage {
 public:
  static vtkProject* New();
  vtkTypeMacro(vtkProject, vtkFoamLimitsStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** Rounds of moves: the last four smooth the wall along the geometry, those before lead it there. */
  vtkSetClampMacro(Rounds, int, 1, 1000);
  vtkGetMacro(Rounds, int);
  ///@}

  /** The properties as the kernel takes them. */
  pm::ProjectOptions Options() const;

 protected:
  vtkProject();
  ~vtkProject() override = default;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int Rounds;

 private:
  vtkProject(const vtkProject&) = delete;
  void operator=(const vtkProject&) = delete;
};
