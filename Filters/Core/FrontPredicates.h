// SPDX-License-Identifier: BSD-3-Clause
// What a front must be for a prism layer to grow on it, as predicates over painted leaves (thesis 3.5.1).
//
// Both look at the eight octants around every corner of every painted leaf; beyond a domain side they are
// mirrored, so that a front meets the side at right angles. O(leaves), parallel.
#pragma once

#include "Octree.h"

namespace pm {

/// Eight octants around a node, bit (x + 2y + 4z) set = painted: is the front there one sheet, a disc? It is
/// when the painted octants hang together by faces, and so do the others (Fig. 3-27).
bool isManifoldPattern(unsigned octants);

/// The front touches itself in no node and no edge. True without a front.
bool frontIsManifold(const Octree& tree, const std::vector<std::uint8_t>& painted);

/// Every front node is in a permitted pattern (Fig. 3-31, see isPermittedPattern()). True without a front.
bool frontIsPermitted(const Octree& tree, const std::vector<std::uint8_t>& painted);

}  // namespace pm
