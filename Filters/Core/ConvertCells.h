// SPDX-License-Identifier: BSD-3-Clause
// A finished mesh of polyhedra as tetrahedra, or as standard cells only: hexahedra, wedges, pyramids and
// tetrahedra. Source: thesis 4.1, 4.3 (central tetrahedra) and 6; the cuts are those of CellCuts.h.
//
// Passes: choose the cuts of faces and cells; assemble the mesh; measure OpenFOAM's skewness, and while faces
// are beyond its limit choose other cuts for the cells at them; count what the mesh holds.
//
// Guarantees: conformal; every new cell has positive volume; patches, zones and old points stay; the faces
// that bound the mesh are those of the input, cut, so that areas and volumes are the same where the input's
// faces are flat, and differ by what the cuts of warped wall faces enclose elsewhere; same bits for any
// number of threads; linear time.
#pragma once

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

enum class CellShapes : std::uint8_t {
  Tetrahedra = 0,
  Hybrid  ///< standard cells stay where their faces can, others become tetrahedra and pyramids
};

struct ConvertCellsOptions {
  CellShapes shapes = CellShapes::Tetrahedra;
};

struct ConvertCellsReport {
  Id tetrahedra = 0, pyramids = 0, wedges = 0, hexahedra = 0;
  Id cellsThatStay = 0;            ///< cells of the input that are cells of the output
  Id cellCentres = 0;              ///< new points in cells
  Id faceCentres = 0;              ///< new points in faces
  double volume = 0;               ///< of the new mesh
  double volumeChange = 0;         ///< that, less the input's volume
  double maxSkewness = 0;          ///< OpenFOAM's; checkMesh fails at 4
  double maxNonOrthogonality = 0;  ///< degrees, OpenFOAM's; it warns above 70
  Id nonOrthogonalFaces = 0;       ///< those above 70
};

/// mesh: of any stage from PaintFront on, normally Refined. The result is Refined: no stage of the chain may
/// follow. Throws InputError when a cell cannot be cut into cells of positive volume (a mesh within the
/// validity limits can), BudgetError when the result is too large for 32-bit ids.
PolyMesh convertCells(const PolyMesh& mesh, const ConvertCellsOptions& options, Monitor& monitor,
                      ConvertCellsReport* report = nullptr);

}  // namespace pm
