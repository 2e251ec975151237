// SPDX-License-Identifier: BSD-3-Clause
// Rooms between walls along the axes, for tests of regions and narrow passages.
#pragma once

#include <array>
#include <functional>

#include "TestSurfaces.h"

namespace pm::testing {

/// Surface between the blocks of a lattice with the given planes. roomAt tells the room of a block by its
/// centre, 0 = solid. Squares between different rooms become two triangles; those of room r and solid are of
/// patch r - 1, those between two rooms of the patch after the last room's.
inline Soup rooms(const std::array<std::vector<double>, 3>& planes, int roomCount,
                  const std::function<int(const Vec3&)>& roomAt) {
  Soup soup;
  soup.names.clear();
  for (int r = 1; r <= roomCount; ++r) soup.names.push_back("room" + std::to_string(r));
  soup.names.push_back("between");
  using Block = std::array<int, 3>;
  const auto room = [&](const Block& b) {
    Vec3 centre;
    for (int a = 0; a < 3; ++a) {
      if (b[a] < 0 || b[a] + 1 >= static_cast<int>(planes[a].size())) return 0;
      centre[a] = 0.5 * (planes[a][b[a]] + planes[a][b[a] + 1]);
    }
    return roomAt(centre);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Block b;
    for (b[axis] = 0; b[axis] < static_cast<int>(planes[axis].size()); ++b[axis])
      for (b[u] = 0; b[u] + 1 < static_cast<int>(planes[u].size()); ++b[u])
        for (b[v] = 0; b[v] + 1 < static_cast<int>(planes[v].size()); ++b[v]) {
          Block before = b;
          --before[axis];
          const int here = room(b), there = room(before);
          if (here == there) continue;
          Vec3 origin, along = Vec3::Zero(), across = Vec3::Zero();
          for (int a = 0; a < 3; ++a) origin[a] = planes[a][b[a]];
          along[u] = planes[u][b[u] + 1] - planes[u][b[u]];
          across[v] = planes[v][b[v] + 1] - planes[v][b[v]];
          soup.addGrid(origin, along, across, 1, here != 0 && there != 0 ? roomCount : here + there - 1);
        }
  }
  return soup;
}

/// Three rooms in a row along x, 1 by 1 by 1, 0.6 and 0.4 long: a thin sheet between the first two at x
/// = 1.013, a wall 0.3 thick before the third.
inline Soup threeRooms() {
  return rooms({std::vector<double>{0.013, 1.013, 1.613, 1.913, 2.313}, {0, 1}, {0, 1}}, 3,
               [](const Vec3& c) {
                 return c[0] < 1.013 ? 1 : c[0] < 1.613 ? 2 : c[0] < 1.913 ? 0 : 3;
               });
}

}  // namespace pm::testing
