// SPDX-License-Identifier: BSD-3-Clause
// The table of permitted patterns (thesis Fig. 3-31), made from the rule that defines them: the front faces
// at the node form one cycle, locally a disc, and no two of them face opposite ways; then one direction sees
// them all.
#include <array>

#include "PaintFront.h"

namespace pm {
namespace {

// Half edges at the node: 2 * axis + (0 towards lower, 1 towards upper coordinates).
bool followsRule(unsigned octants) {
  int atEdge[6][4] = {}, degree[6] = {};  // faces at each half edge
  int edgesOf[12][2];
  bool normal[6] = {};
  int faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int su = quarter & 1, sv = quarter >> 1;
      const unsigned lower = unsigned(su) << u | unsigned(sv) << v, upper = lower | 1u << axis;
      const bool lowerPainted = octants >> lower & 1, upperPainted = octants >> upper & 1;
      if (lowerPainted == upperPainted) continue;
      normal[2 * axis + (lowerPainted ? 1 : 0)] = true;
      const int e[2] = {2 * u + su, 2 * v + sv};
      for (int k = 0; k < 2; ++k) {
        atEdge[e[k]][degree[e[k]]++] = faces;
        edgesOf[faces][k] = e[k];
      }
      ++faces;
    }
  }
  if (faces == 0) return false;
  for (int e = 0; e < 6; ++e)
    if (degree[e] != 0 && degree[e] != 2) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (normal[2 * axis] && normal[2 * axis + 1]) return false;
  int visited = 0, face = 0, edge = edgesOf[0][0];  // walk the cycle from face 0
  do {
    ++visited;
    edge = edgesOf[face][0] == edge ? edgesOf[face][1] : edgesOf[face][0];
    face = atEdge[edge][0] == face ? atEdge[edge][1] : atEdge[edge][0];
  } while (face != 0);
  return visited == faces;
}

std::array<bool, 256> makeTable() {
  std::array<bool, 256> table{};
  for (unsigned p = 0; p < 256; ++p) table[p] = followsRule(p);
  return table;
}

}  // namespace

bool isPermittedPattern(unsigned octants) {
  static const std::array<bool, 256> table = makeTable();
  return table[octants & 255];
}

}  // namespace pm
