// SPDX-License-Identifier: BSD-3-Clause
#include "FrontPredicates.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "PaintFront.h"

namespace pm {
namespace {

unsigned patternAt(const Octree& tree, const std::vector<std::uint8_t>& painted, const Coord& node) {
  unsigned octants = 0;
  for (int k = 0; k < 8; ++k) {
    Coord c;
    for (int a = 0; a < 3; ++a)
      c[a] = std::clamp(node[a] - ((k >> a & 1) ? 0 : 1), 0, tree.brick.extent(a) - 1);
    if (painted[tree.find(c)]) octants |= 1u << k;
  }
  return octants;
}

template <class Holds>
bool allFrontNodes(const Octree& tree, const std::vector<std::uint8_t>& painted, const Holds& holds) {
  return tbb::parallel_reduce(
      tbb::blocked_range<Id>(0, tree.size(), 1024), true,
      [&](const tbb::blocked_range<Id>& block, bool ok) {
        for (Id leaf = block.begin(); ok && leaf < block.end(); ++leaf) {
          if (!painted[leaf]) continue;
          const std::int32_t span = tree.brick.span(tree.levels[leaf]);
          for (int k = 0; ok && k < 8; ++k) {
            Coord node = tree.corner(leaf);
            for (int a = 0; a < 3; ++a) node[a] += (k >> a & 1) * span;
            const unsigned octants = patternAt(tree, painted, node);
            ok = octants == 255 || holds(octants);
          }
        }
        return ok;
      },
      [](bool a, bool b) { return a && b; });
}

/// Do the octants of the set hang together by faces? True for the empty set.
bool hangTogether(unsigned set) {
  unsigned reached = set & (~set + 1);  // its lowest octant
  for (int round = 0; round < 7; ++round)
    for (int k = 0; k < 8; ++k)
      if (reached >> k & 1)
        for (int a = 0; a < 3; ++a) reached |= set & (1u << (k ^ (1 << a)));
  return reached == set;
}

}  // namespace

bool isManifoldPattern(unsigned octants) {
  octants &= 255;
  return octants != 0 && octants != 255 && hangTogether(octants) && hangTogether(~octants & 255);
}

bool frontIsManifold(const Octree& tree, const std::vector<std::uint8_t>& painted) {
  return allFrontNodes(tree, painted, isManifoldPattern);
}

bool frontIsPermitted(const Octree& tree, const std::vector<std::uint8_t>& painted) {
  return allFrontNodes(tree, painted, isPermittedPattern);
}

}  // namespace pm
