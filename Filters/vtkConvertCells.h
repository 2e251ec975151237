// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkConvertCells
 * @brief a finished mesh as tetrahedra, or as standard cells only
 *
 * Input: the grid of any stage from vtkPaintFront on, normally the finished mesh. The output has the same
 * boundary patches and zones; it is a finished mesh, which no further stage takes. Source: thesis sections
 * 4.1, 4.3 and 6.
 */
#pragma once

#include <memory>

#include "vtkMeshStage.h"

namespace pm {
struct ConvertCellsReport;
}

class PROJECTIONMESHERFILTERS_EXPORT vtkConvertCells : public vtkMeshStage {
 public:
  static vtkConvertCells* New();
  vtkTypeMacro(vtkConvertCells, vtkMeshStage);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum { TETRAHEDRA = 0, HYBRID };
  ///@{
  /** 0 = tetrahedra only; 1 = hexahedra, wedges and pyramids stay where their faces can. */
  vtkSetClampMacro(CellShapes, int, TETRAHEDRA, HYBRID);
  vtkGetMacro(CellShapes, int);
  ///@}

  ///@{
  /** What the last run made. */
  vtkIdType GetTetrahedra() const;
  vtkIdType GetPyramids() const;
  vtkIdType GetWedges() const;
  vtkIdType GetHexahedra() const;
  vtkIdType GetCellsThatStay() const;
  vtkIdType GetCellCentres() const;
  vtkIdType GetFaceCentres() const;
  double GetVolume() const;
  double GetVolumeChange() const;
  double GetMaxSkewness() const;
  double GetMaxNonOrthogonality() const;
  vtkIdType GetNonOrthogonalFaces() const;
  ///@}

 protected:
  vtkConvertCells();
  ~vtkConvertCells() override;
  void Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
           pm::Monitor& monitor) override;

  int CellShapes;

 private:
  vtkConvertCells(const vtkConvertCells&) = delete;
  void operator=(const vtkConvertCells&) = delete;

  std::unique_ptr<pm::ConvertCellsReport> Report;
};
