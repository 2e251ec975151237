// SPDX-License-Identifier: BSD-3-Clause
#include "Watershed.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace pm {
namespace {

constexpr double kPlateau = 1.1;  // ways whose widths differ by less count as equally wide

std::vector<Id> byFallingClearance(const std::vector<double>& clearance) {
  std::vector<Id> order;
  for (Id leaf = 0; leaf < static_cast<Id>(clearance.size()); ++leaf)
    if (clearance[leaf] >= 0) order.push_back(leaf);
  tbb::parallel_sort(order.begin(), order.end(), [&](Id a, Id b) {
    return clearance[a] != clearance[b] ? clearance[a] > clearance[b] : a < b;
  });
  return order;
}

/// Basins while they grow. The outside is one basin from the start, and higher than any other.
class Basins {
 public:
  struct Basin {
    Id parent;
    Pocket pocket;
    bool outside = false;
    bool frozen = false;  // met the outside and was roomy: stays apart from it
  };

  Basins(const Octree& tree, const std::vector<double>& clearance, double roominess, double smallestVolume)
      : tree_(tree), clearance_(clearance), roominess_(roominess), smallestVolume_(smallestVolume) {
    basins_.push_back({0, {}, true, false});
  }

  Id create(Id leaf) {
    const Id row = static_cast<Id>(basins_.size());
    basins_.push_back({row, {leaf, clearance_[leaf], 0, 0}, false, false});
    return row;
  }
  Id root(Id basin) {
    while (basins_[basin].parent != basin)
      basin = basins_[basin].parent = basins_[basins_[basin].parent].parent;
    return basin;
  }
  void add(Id basin, Id leaf) {
    basins_[basin].pocket.volume += tree_.brick.cellSize(tree_.levels[leaf]).prod();
  }
  /// The two basins touch at a level of clearance.
  void meet(Id a, Id b, double level) {
    a = root(a), b = root(b);
    if (a == b) return;
    if (higher(b, a)) std::swap(a, b);
    Basin& low = basins_[b];
    if (basins_[a].outside) {
      if (low.frozen) return;
      const bool roomy = low.pocket.peakClearance >= roominess_ * level;
      if (roomy && low.pocket.volume >= smallestVolume_) {
        low.frozen = true;
        low.pocket.saddle = level;
        return;
      }
    }
    low.parent = a;
    basins_[a].pocket.volume += low.pocket.volume;
    basins_[a].pocket.saddle = std::max(basins_[a].pocket.saddle, low.pocket.saddle);
    basins_[a].frozen = !basins_[a].outside && (basins_[a].frozen || low.frozen);
  }
  const Basin& operator[](Id basin) const { return basins_[basin]; }
  Id size() const { return static_cast<Id>(basins_.size()); }

 private:
  bool higher(Id a, Id b) const {
    if (basins_[a].outside != basins_[b].outside) return basins_[a].outside;
    const Pocket &p = basins_[a].pocket, &q = basins_[b].pocket;
    return p.peakClearance != q.peakClearance ? p.peakClearance > q.peakClearance : p.peak < q.peak;
  }
  const Octree& tree_;
  const std::vector<double>& clearance_;
  double roominess_, smallestVolume_;
  std::vector<Basin> basins_;
};

}  // namespace

Pockets findPockets(const Octree& tree, const std::vector<double>& clearance, const Csr<Id>& graph,
                    const std::vector<Id>& outside, double roominess, double smallestVolume) {
  Basins basins(tree, clearance, roominess, smallestVolume);
  std::vector<Id> basin(tree.size(), kNone);
  for (Id leaf : outside) basin[leaf] = 0;
  std::vector<std::uint8_t> flooded(tree.size(), 0);
  for (Id leaf : byFallingClearance(clearance)) {
    Id steepest = kNone;
    for (Id n : graph[leaf])
      if (flooded[n] && (steepest == kNone || clearance[n] > clearance[steepest] ||
                         (clearance[n] == clearance[steepest] && n < steepest)))
        steepest = n;
    flooded[leaf] = 1;
    if (basin[leaf] == kNone)
      basin[leaf] = steepest == kNone ? basins.create(leaf) : basins.root(basin[steepest]);
    basins.add(basins.root(basin[leaf]), leaf);
    for (Id n : graph[leaf])
      if (flooded[n]) basins.meet(basin[leaf], basin[n], clearance[leaf]);
  }
  Pockets found;
  std::vector<Id> rows, rowOf(basins.size(), kNone);
  for (Id b = 1; b < basins.size(); ++b)
    if (basins.root(b) == b && basins[b].frozen) rows.push_back(b);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](Id a, Id b) { return basins[a].pocket.volume > basins[b].pocket.volume; });
  for (Id b : rows) {
    rowOf[b] = static_cast<Id>(found.pockets.size());
    found.pockets.push_back(basins[b].pocket);
  }
  found.pocketOfLeaf.assign(tree.size(), kNone);
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (basin[leaf] != kNone) found.pocketOfLeaf[leaf] = rowOf[basins.root(basin[leaf])];
  return found;
}

std::vector<Side> floodSides(const Octree& tree, const std::vector<double>& clearance, const Csr<Id>& graph,
                             const std::vector<Marker>& inside, const std::vector<Id>& outside) {
  const auto stepOf = [](double width) {
    return static_cast<int>(std::floor(std::log(width) / std::log(kPlateau)));
  };
  struct Wave {
    int step;  // width of the way so far, in steps of kPlateau
    int from;  // clearance of the leaf before, likewise: a leaf by the wall belongs to what is roomy beside
               // it
    Side side;
    double width;
    Id leaf;
    bool operator<(const Wave& o) const {  // what a heap takes last
      if (step != o.step) return step < o.step;
      if (from != o.from) return from < o.from;
      if (side != o.side) return side == Side::Outside;
      return width != o.width ? width < o.width : leaf > o.leaf;
    }
  };
  std::vector<Side> sides(tree.size(), Side::None);
  std::priority_queue<Wave> heap;
  const auto spread = [&](Id leaf, Side side, double width) {
    sides[leaf] = side;
    const int from = stepOf(clearance[leaf]);
    for (Id n : graph[leaf]) {
      if (sides[n] != Side::None) continue;
      const double narrowed = std::min(width, clearance[n]);
      heap.push({stepOf(narrowed), from, side, narrowed, n});
    }
  };
  for (const Marker& m : inside) sides[m.leaf] = Side::Inside;
  for (Id leaf : outside) sides[leaf] = Side::Outside;
  constexpr double unlimited = std::numeric_limits<double>::max();
  for (const Marker& m : inside) spread(m.leaf, Side::Inside, m.width);
  for (Id leaf : outside) spread(leaf, Side::Outside, unlimited);
  while (!heap.empty()) {
    const Wave next = heap.top();
    heap.pop();
    if (sides[next.leaf] == Side::None) spread(next.leaf, next.side, next.width);
  }
  return sides;
}

}  // namespace pm
