// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPolyMeshWriter
 * @brief a mesh of the suite as an OpenFOAM polyMesh folder
 *
 * Input: port 0 of any filter from vtkPaintFront on. With FileName "case/any.foam" the mesh goes to
 * case/constant/polyMesh, where OpenFOAM looks for it, and the empty any.foam is made so that ParaView opens
 * the case. With Directory the five files go into that very folder.
 */
#pragma once

#include "ProjectionMesherFiltersModule.h"  // for export macro
#include "vtkWriter.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkPolyMeshWriter : public vtkWriter {
 public:
  static vtkPolyMeshWriter* New();
  vtkTypeMacro(vtkPolyMeshWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The .foam file of a case. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}
  ///@{
  /** The polyMesh folder itself; used instead of FileName when set. */
  vtkSetFilePathMacro(Directory);
  vtkGetFilePathMacro(Directory);
  ///@}
  ///@{
  /** Binary files are smaller and faster; ascii ones can be read by people. */
  vtkSetMacro(Binary, bool);
  vtkGetMacro(Binary, bool);
  vtkBooleanMacro(Binary, bool);
  ///@}

 protected:
  vtkPolyMeshWriter() = default;
  ~vtkPolyMeshWriter() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  char* FileName = nullptr;
  char* Directory = nullptr;
  bool Binary = true;

 private:
  vtkPolyMeshWriter(const vtkPolyMeshWriter&) = delete;
  void operator=(const vtkPolyMeshWriter&) = delete;
};
