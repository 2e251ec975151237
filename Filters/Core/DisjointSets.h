// SPDX-License-Identifier: BSD-3-Clause
// Union-find over ids 0 .. count-1, for one thread. The root of a set is its smallest id, so what is numbered
// by roots does not depend on the order of joining. Many threads at once: connectedLeaves() in Regions.h.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "Types.h"

namespace pm {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  Id root(Id i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Id a, Id b) {
    const auto [lo, hi] = std::minmax({root(a), root(b)});
    parent_[hi] = lo;
  }

 private:
  std::vector<Id> parent_;
};

}  // namespace pm
