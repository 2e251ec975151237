// SPDX-License-Identifier: BSD-3-Clause
// Rooms that a region takes in through openings a few cells wide: leaks though nobody said where inside is.
//
// The coarse-to-fine painting of thesis 3.6.1 on one octree. An open cell is an aligned cube, as large as
// possible, that no cut leaf lies in. Open cells join in the order of falling size, those among open space
// first; a part that joins the region's main part late, through cells much smaller than the part itself, may
// be a room behind a narrow opening. Clearances are measured only in the shell of cells between such a part
// and the main one, so the work is O(leaves) with a small constant, and a region without such rooms costs
// little more than finding the open cells.
//
// A room is reported when it is at least kRoomy times as wide as its widest way in, and that way is at most
// kHandful cells wide: a funnel, a recess or a wheel arch is no room.
#pragma once

#include <vector>

#include "LeakPaths.h"
#include "Regions.h"

namespace pm {

struct LeakedRoom {
  static constexpr double kRoomy = 3;    ///< width of the room over that of the opening, at least
  static constexpr double kHandful = 8;  ///< its width over the edge of the cells at its rim, at most

  Id region = kNone;
  Vec3 point = Vec3::Zero();  ///< a place in the room that is wider than those around it
  double width = 0;           ///< twice the clearance there, length
  double volume = 0;          ///< of the open cells that joined before the opening did
  Vec3 place = Vec3::Zero();  ///< in the opening
  double opening = 0;        ///< twice the clearance there, length; at centres of cells, hence a little small
  double cell = 0;           ///< edge of the leaf at the rim of the opening, length
  Vec3 main = Vec3::Zero();  ///< a free place in the main part
};

struct LeakedRooms {
  std::vector<LeakedRoom> rooms;  ///< largest volume first
  std::vector<Id> mainLeaves;     ///< of the main parts when their first room joined; free leaves, ascending
};

/// Rooms of the chosen regions (#regions). The main part of a region holds one of the leaves of home, and is
/// else its largest.
LeakedRooms findLeakedRooms(const Octree& tree, const SurfaceModel& model, const Regions& regions,
                            const std::vector<std::uint8_t>& chosen, const std::vector<Id>& home,
                            Monitor& monitor);

/// The rooms whose ways in bear the measure, and these ways, widest first.
struct RoomLeaks {
  std::vector<LeakedRoom> rooms;
  std::vector<Leak> leaks;
};
RoomLeaks findRoomLeaks(const Octree& tree, const SurfaceModel& model, const Regions& regions,
                        const std::vector<std::uint8_t>& chosen, const std::vector<Id>& home,
                        Monitor& monitor);

/// What was found and what to do about it; empty when nothing was.
std::string describe(const RoomLeaks& found);

}  // namespace pm
