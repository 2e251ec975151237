// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: which leaves are the domain, and a front that a prism layer can grow on (thesis 3.4.2, 3.5).
#pragma once

#include "LeakedRooms.h"
#include "Monitor.h"
#include "NarrowPassages.h"
#include "Octree.h"
#include "PolyMesh.h"
#include "Regions.h"
#include "SurfaceModel.h"

namespace pm {

enum class Region : std::uint8_t {
  Inside = 0,      ///< the largest enclosed region
  Outside = 1,     ///< everything connected to the domain's sides
  Points = 2,      ///< the regions that hold the given points
  Enclosed = 3,    ///< every enclosed region
  Everything = 4,  ///< every region
  Ids = 5,         ///< the regions of the given ids
  Patches = 6,     ///< the enclosed regions that touch a given patch
};

struct PaintFrontOptions {
  Region region = Region::Inside;
  std::vector<Vec3> points;          ///< for Region::Points
  std::vector<Id> ids;               ///< for Region::Ids: places in PaintFrontReport::regions
  std::vector<std::string> patches;  ///< for Region::Patches; touching any of them is enough
  std::vector<Vec3> keepOut;         ///< points that must not be meshed: the region leaks where it holds one
  bool allowOpen = false;            ///< accept a named region that reaches the sides of an undeclared domain
  bool fill = true;                  ///< front filling (Fig. 3-33)
  bool reportInvisible = true;       ///< look for free space that is too narrow for the leaves
  bool reportLeaks = true;           ///< look for rooms behind openings a few cells wide, and warn of them
};

struct PaintFrontReport {
  std::vector<PaintedRegion> regions;  ///< largest volume first
  std::vector<Id> regionOfCell;        ///< #C
  std::vector<std::uint8_t> painted;   ///< #L 1 = the leaf is a cell of the mesh
  NarrowPassages invisible;            ///< free space that is too narrow for the leaves
  RoomLeaks leaked;                    ///< rooms of the mesh behind openings a few cells wide
  std::vector<std::string> notes;      ///< sentences for the user: what became invisible or is not meshed
  Id chosenCells = 0, grown = 0, removed = 0, filled = 0;
};

/// The domain's leaves as a mesh: cells in Morton order, front faces as boundary faces of patch 0.. by the
/// closest triangle, domain sides in patches of their own. Every front node is in a permitted pattern (Fig.
/// 3-31). Of several regions each is a zone of the mesh, and no two zones share a node. Throws RegionError
/// when nothing is enclosed, a point lies outside or on the geometry, or the region leaks.
PolyMesh paintFront(const Octree& tree, const SurfaceModel& model, const PaintFrontOptions& options,
                    Monitor& monitor, PaintFrontReport* report = nullptr);

/// Eight octants around a node, bit (x + 2y + 4z) set = painted: may a front pass here?
bool isPermittedPattern(unsigned octants);

}  // namespace pm
