// SPDX-License-Identifier: BSD-3-Clause
// A mesh as an OpenFOAM polyMesh folder: points, faces, owner, neighbour, boundary, and cellZones when the
// mesh has zones.
#pragma once

#include <string>
#include <vector>

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

/// Writes a canonical mesh (its internal faces are then in OpenFOAM's upper-triangular order) into
/// `directory`, which is made when it does not exist. Boundary faces are grouped by patch, in the order of
/// the patches; a patch without faces is left out, since OpenFOAM wants a boundary condition for each patch
/// it finds. Coordinates keep every bit in ascii too. Either all files are replaced, or none: they are
/// written beside the old ones first. Files of a former mesh that would contradict the new one (zones,
/// compressed copies) are removed. Throws InputError when the folder cannot be written or the disk is full,
/// AbortError on request.
void writePolyMesh(const PolyMesh& mesh, const std::string& directory, bool binary, Monitor& monitor);

/// OpenFOAM's type of patch `patchId`: "empty" for the planes of a planar mesh, "patch" for a domain side and for a patch of the geometry whose name
/// tells that flow passes it (it contains inlet, outlet, inflow, outflow, opening or farfield, in any case),
/// else "wall".
std::string foamPatchType(const PolyMesh& mesh, Id patchId);

/// The names as OpenFOAM words: letters, digits, '_', '-', '.', a letter or '_' first, no two alike.
std::vector<std::string> foamPatchNames(const std::vector<std::string>& names);

}  // namespace pm
