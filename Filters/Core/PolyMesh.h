// SPDX-License-Identifier: BSD-3-Clause
// A polyhedral mesh as a structure of arrays: points, faces as rows of points, owner and neighbour cells,
// patches.
//
// Each face is stored once. Internal faces come first; a face's points run counter-clockwise seen from its
// neighbour (the normal leaves the owner). Canonical order (see canonicalise) makes a mesh that was saved and
// read back equal to the one that never left memory, bit for bit.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "Types.h"

namespace pm {

/// How far along the chain a mesh is.
enum class Stage : std::uint8_t { None = 0, Octree, Front, Layer, Projected, Resolved, Refined };

struct PolyMesh {
  std::vector<Vec3> points;   // #P by 3
  Csr<Id> faces;              // #F rows of point ids
  std::vector<Id> owner;      // #F
  std::vector<Id> neighbour;  // #internal faces
  std::vector<Id> patch;      // #boundary faces: patch of face internalFaces()+i
  std::vector<std::string> patchNames;
  std::vector<std::string>
      patchTypes;  // "wall" (from the geometry), "patch" (a domain side) or "empty" (a planar mesh's planes)
  Id cellCount = 0;

  std::vector<std::uint8_t> level;     // #C octree level; a layer cell has its front cell's
  std::vector<std::uint8_t> layer;     // #C 0 = not a layer cell, 1 = at the wall, 2 = next to it, ...
  std::vector<Id> zone;                // #C zone of each cell; empty when the mesh is one zone
  std::vector<std::string> zoneNames;  // of each zone; empty when the mesh is one zone
  std::vector<std::uint8_t>
      fixed;              // #P bit a set: coordinate a may not move (the point lies on a domain side)
  std::vector<Id> base;   // #P for a wall point the lower end of its prism edge, else kNone
  double finestSize = 0;  // edge of the smallest octree cell, the unit of volume limits
  Stage stage = Stage::None;

  Id faceCount() const { return faces.rows(); }
  Id internalFaces() const { return static_cast<Id>(neighbour.size()); }
  Id boundaryFaces() const { return faceCount() - internalFaces(); }
  bool isWallPatch(Id patchId) const { return patchTypes[patchId] == "wall"; }
};

/// Puts cells' faces in the one order that follows from the cells alone: each face starts at its smallest
/// point id, internal faces ascend by (owner, neighbour, points) and point from the smaller cell id to the
/// larger, boundary faces ascend by (owner, points). Every stage ends with it.
void canonicalise(PolyMesh& mesh);

/// Faces of each cell, ascending.
Csr<Id> cellFaces(const PolyMesh& mesh);
/// Cells around each point, given cellFaces() / faces around each point, ascending.
Csr<Id> pointCells(const PolyMesh& mesh, const Csr<Id>& facesOfCell);
Csr<Id> pointFaces(const PolyMesh& mesh);

/// Empty when the invariants hold, else one sentence naming the first that does not: ids in range, owner <
/// neighbour, faces of three or more different points, every cell closed (each of its edges in exactly two of
/// its faces), arrays of the right length, every point used, the boundary manifold (each boundary edge in two
/// boundary faces), no face between cells of two zones.
std::string checkTopology(const PolyMesh& mesh);

/// Sum over the arrays that a saved grid must bring back unchanged; recognises a mesh that another tool has
/// edited.
std::uint64_t checksum(const PolyMesh& mesh);

}  // namespace pm
