// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSurfaceReader
 * @brief triangle geometry from .stl, .obj, .ply and .vtp files, also gzip'd, with the names of its parts
 *
 * VTK's own readers read the geometry; this one adds the cell array PatchId and the field string array
 * PatchNames from the solids of an STL file or the groups (else objects) of an OBJ file. Parts of one name
 * are one patch; parts without a name are called after the file. Lines and vertices are dropped.
 */
#pragma once

#include "ProjectionMesherFiltersModule.h"  // for export macro
#include "vtkPolyDataAlgorithm.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkSurfaceReader : public vtkPolyDataAlgorithm {
 public:
  static vtkSurfaceReader* New();
  vtkTypeMacro(vtkSurfaceReader, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file; its ending (before .gz) tells the format. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

 protected:
  vtkSurfaceReader();
  ~vtkSurfaceReader() override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override;

  char* FileName = nullptr;

 private:
  vtkSurfaceReader(const vtkSurfaceReader&) = delete;
  void operator=(const vtkSurfaceReader&) = delete;
};
