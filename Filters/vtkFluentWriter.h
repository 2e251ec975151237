// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkFluentWriter
 * @brief a mesh of the suite as a Fluent mesh file (.msh)
 *
 * Input: port 0 of any filter from vtkPaintFront on. Hexahedra, wedges, pyramids and tetrahedra are written
 * as such, other cells as polyhedra; each patch is a zone of faces with its name and a boundary condition,
 * each zone of a mesh of several regions a zone of cells. The file is replaced only when it could be written
 * whole.
 */
#pragma once

#include "ProjectionMesherFiltersModule.h"  // for export macro
#include "vtkWriter.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkFluentWriter : public vtkWriter {
 public:
  static vtkFluentWriter* New();
  vtkTypeMacro(vtkFluentWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The .msh file. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}
  ///@{
  /** Binary files are smaller and faster; ascii ones can be read by people and by more programs. */
  vtkSetMacro(Binary, bool);
  vtkGetMacro(Binary, bool);
  vtkBooleanMacro(Binary, bool);
  ///@}

 protected:
  vtkFluentWriter() = default;
  ~vtkFluentWriter() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  char* FileName = nullptr;
  bool Binary = true;

 private:
  vtkFluentWriter(const vtkFluentWriter&) = delete;
  void operator=(const vtkFluentWriter&) = delete;
};
