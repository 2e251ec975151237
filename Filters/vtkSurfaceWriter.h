// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSurfaceWriter
 * @brief a surface as an ascii STL file with a solid for each patch
 *
 * The counterpart of vtkSurfaceReader. Input: the Boundary output of any filter of the suite, or any polygons
 * with the cell array PatchId and the field string array PatchNames; without PatchId all is one solid that is
 * called after the file. Polygons are written as triangles that join without gaps and enclose the mesh's
 * volume (see pm::writeStl); strips become triangles, lines and vertices are dropped. The file is replaced
 * only when it could be written whole.
 */
#pragma once

#include "ProjectionMesherFiltersModule.h"  // for export macro
#include "vtkWriter.h"

class PROJECTIONMESHERFILTERS_EXPORT vtkSurfaceWriter : public vtkWriter {
 public:
  static vtkSurfaceWriter* New();
  vtkTypeMacro(vtkSurfaceWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The .stl file. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

 protected:
  vtkSurfaceWriter() = default;
  ~vtkSurfaceWriter() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  char* FileName = nullptr;

 private:
  vtkSurfaceWriter(const vtkSurfaceWriter&) = delete;
  void operator=(const vtkSurfaceWriter&) = delete;
};
