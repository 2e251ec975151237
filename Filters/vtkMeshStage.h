// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkMeshStage
 * @brief what all filters of the suite share
 *
 * A stage takes the mesh of the stage before (port "Input") and, where it needs it, the triangle geometry
 * (port "Geometry": vtkPolyData or a composite of them), and makes a volume grid (output port 0) and, from
 * PaintFront on, its boundary faces (output port 1). A stage that has more to show has further ports,
 * polydata unless its FillOutputPortInformation() says otherwise, and fills them with GetOutputDataObject().
 * A subclass implements Run(); this class reports progress, forwards an abort and turns each error of the
 * kernel into one vtkErrorMacro, empty outputs and a failed request.
 */
#pragma once

#include <memory>

#include "ProjectionMesherFiltersModule.h"  // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

class vtkPolyData;
namespace pm {
class Monitor;
class SurfaceModel;
struct PolyMesh;
enum class Stage : unsigned char;
}  // namespace pm

class PROJECTIONMESHERFILTERS_EXPORT vtkMeshStage : public vtkUnstructuredGridAlgorithm {
 public:
  vtkAbstractTypeMacro(vtkMeshStage, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Number of threads this filter may use; 0 = all. The result does not depend on it.
   */
  vtkSetClampMacro(Threads, int, 0, VTK_INT_MAX);
  vtkGetMacro(Threads, int);
  ///@}

  ///@{
  /**
   * Cell array of the geometry that says which patch a triangle belongs to. Empty (the default) takes the
   * names of a composite's blocks, else the first known array (PatchId, GroupIds, STLSolidLabeling, ...),
   * else one patch "wall".
   */
  vtkSetStringMacro(PatchArray);
  vtkGetStringMacro(PatchArray);
  ///@}

 protected:
  /// geometryPort: input port that takes the triangles, -1 = none; the other port takes a grid of the suite.
  vtkMeshStage(int inputPorts, int geometryPort, int outputPorts);
  ~vtkMeshStage() override;

  /// Everything a filter does; throws pm::Error. boundary is null for a stage of one output port.
  virtual void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                   pm::Monitor& monitor) = 0;

  /// The triangles on the geometry port, shared with all filters that read the same geometry. This filter
  /// holds them until its next run, so that a change of an option need not prepare them again.
  std::shared_ptr<const pm::SurfaceModel> Surface(vtkInformationVector** inputs);

  /// To be called when Run() has read all it needs of a grid on an input port: frees the grid now, where it
  /// would be freed after this filter anyway (ReleaseDataFlag of the filter before), rather than hold it
  /// through the run.
  static void DoneWith(vtkInformationVector* input);

  /// Called when Run() has thrown and the outputs are empty: a stage that can show why fills an output of its
  /// own.
  virtual void ShowFailure() {}

  /// For an input port that takes a polydata or a composite of them, and may be left empty.
  static int DescribeOptionalPort(vtkInformation* info);

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

  int Threads = 0;
  char* PatchArray = nullptr;

 private:
  vtkMeshStage(const vtkMeshStage&) = delete;
  void operator=(const vtkMeshStage&) = delete;

  /// Runs and catches; true when the stage came to its end.
  bool RunSafely(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary);

  const int GeometryPort;
  std::shared_ptr<const pm::SurfaceModel> Held;
};
