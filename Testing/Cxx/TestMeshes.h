// SPDX-License-Identifier: BSD-3-Clause
// Small meshes built by hand for the kernel's tests.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "PolyMesh.h"

namespace pm::testing {

using Face = std::vector<Id>;  // seen from outside its cell: counter-clockwise
using CellFaces = std::vector<Face>;

/// Joins cells into a mesh; faces with the same points are one. boundaryPatch names the patch of a face
/// nobody shares. All arrays are filled: level, layer, fixed 0, base kNone, finestSize 1.
PolyMesh joinCells(std::vector<Vec3> points, const std::vector<CellFaces>& cells,
                   std::vector<std::string> patchNames, std::vector<std::string> patchTypes,
                   const std::function<Id(const Face&)>& boundaryPatch);

/// Faces of a prism over a polygon: bottom and top list corresponding points, counter-clockwise seen from the
/// top.
CellFaces prism(const std::vector<Id>& bottom, const std::vector<Id>& top);

/// Unit voxels with one prism on each free face that is a wall. Patch 0 "wall", then xmin .. zmax for domain
/// sides.
struct VoxelOptions {
  std::array<int, 3> size{3, 3, 3};
  std::function<bool(int, int, int)> occupied = [](int, int, int) { return true; };
  std::array<bool, 6> wallSide{true, true, true, true, true, true};  ///< xmin, xmax, .. : wall or domain side
  double thickness = 1.0 / 3;                                        ///< offset of wall planes
  std::function<Vec3(const Vec3&)> deform = [](const Vec3& p) { return p; };
};
PolyMesh layeredVoxels(const VoxelOptions& options);

/// A room around a solid cube at coordinates of odd digits, with walls and domain sides.
inline PolyMesh hollowRoom() {
  VoxelOptions o;
  o.occupied = [](int i, int j, int k) { return !(i == 1 && j == 1 && k == 1); };
  o.wallSide = {false, false, true, true, false, true};
  o.deform = [](const Vec3& p) { return Vec3(p / 3 + Vec3(1e-7, 1e6, -1.0 / 7)); };
  return layeredVoxels(o);
}

/// A solid unit cube in the middle of a box: every wall edge is convex.
inline VoxelOptions cubeInBox() {
  VoxelOptions o;
  o.size = {5, 5, 5};
  o.wallSide = {false, false, false, false, false, false};
  o.occupied = [](int i, int j, int k) { return !(i == 2 && j == 2 && k == 2); };
  return o;
}

/// A flat sheet of polygons, extruded: a core cell from z = -1 to 0 and a prism from 0 to `height` for each;
/// wall above, domain sides elsewhere.
PolyMesh layeredPolygons(const std::vector<std::array<double, 2>>& points, const std::vector<Face>& polygons,
                         double height);

/// Merges wall point `gone` into `kept`: faces lose the edge between them, faces of two points disappear.
PolyMesh mergeWallPoints(const PolyMesh& mesh, Id kept, Id gone);

/// The same mesh with its faces in another order, and internal faces turned around at random.
PolyMesh shuffled(const PolyMesh& mesh, unsigned seed);

}  // namespace pm::testing
