// SPDX-License-Identifier: BSD-3-Clause
#include "Regions.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>

#include "ThinPlaces.h"
#include "TriangleBox.h"

namespace pm {
namespace {

template <class Body>
void forLeaves(Id count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Id>(0, count, 2048), [&](const tbb::blocked_range<Id>& block) {
    for (Id leaf = block.begin(); leaf != block.end(); ++leaf) body(leaf);
  });
}

/// Disjoint sets that many threads join at once. The larger root always goes under the smaller, so the root
/// of a set is its smallest member whatever the order.
class DisjointSets {
 public:
  explicit DisjointSets(Id count) : parent_(new std::atomic<Id>[count]) {
    forLeaves(count, [&](Id i) { parent_[i].store(i, std::memory_order_relaxed); });
  }
  Id root(Id i) {
    for (;;) {
      const Id up = parent_[i].load(std::memory_order_relaxed);
      if (up == i) return i;
      const Id above = parent_[up].load(std::memory_order_relaxed);
      if (above != up) parent_[i].store(above, std::memory_order_relaxed);
      i = above;
    }
  }
  void join(Id a, Id b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      Id expected = a;
      if (parent_[a].compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::unique_ptr<std::atomic<Id>[]> parent_;
};

bool touchesSides(const Octree& tree, Id leaf) {
  const Coord c = tree.corner(leaf);
  const std::int32_t span = tree.brick.span(tree.levels[leaf]);
  for (int a = 0; a < 3; ++a)
    if (c[a] == 0 || c[a] + span == tree.brick.extent(a)) return true;
  return false;
}

/// What one pass over a region's leaves collects, in whole finest cells: exact in any order.
struct Tally {
  Key volume = 0;
  Coord lo{}, hi{};
  Id cells = 0, largest = kNone;
  bool open = false;
  void add(const Octree& tree, Id leaf) {
    const Coord c = tree.corner(leaf);
    const std::int32_t span = tree.brick.span(tree.levels[leaf]);
    for (int a = 0; a < 3; ++a) {
      lo[a] = cells == 0 ? c[a] : std::min(lo[a], c[a]);
      hi[a] = cells == 0 ? c[a] + span : std::max(hi[a], c[a] + span);
    }
    volume += Key(1) << (3 * (tree.brick.maxLevel - tree.levels[leaf]));
    ++cells;
    if (tree.cut[leaf]) return;  // it only links others
    open = open || touchesSides(tree, leaf);
    if (largest == kNone || tree.levels[leaf] < tree.levels[largest]) largest = leaf;
  }
};

PaintedRegion describe(const Octree& tree, const Tally& tally) {
  PaintedRegion region;
  region.cells = tally.cells;
  region.volume = double(tally.volume) * tree.brick.cellSize(tree.brick.maxLevel).prod();
  region.open = tally.open;
  region.bounds = {tree.brick.position(tally.lo), tree.brick.position(tally.hi)};
  region.point = tree.box(tally.largest).centre();
  return region;
}

/// Pairs of a region and a patch as one number each, so that sorting makes them rows.
using Contact = std::uint64_t;

void addContacts(const Octree& tree, const SurfaceModel& model, const std::vector<Id>& regionOf, Id leaf,
                 std::vector<Contact>& contacts) {
  std::array<Id, 4> n;
  Id beside[24];
  int count = 0;
  for (int side = 0; side < 6; ++side)
    for (int k = tree.faceNeighbours(leaf, side, n); k-- > 0;) {
      const Id region = regionOf[n[k]];
      if (region != kNone && std::find(beside, beside + count, region) == beside + count)
        beside[count++] = region;
    }
  if (count == 0) return;
  Id last = kNone;
  for (Id t : tree.triangles[leaf]) {
    const Id patch = model.patchOf(t);
    if (patch == last) continue;
    last = patch;
    for (int i = 0; i < count; ++i) contacts.push_back(Contact(beside[i]) << 32 | Contact(patch));
  }
}

void findPatches(const Octree& tree, const SurfaceModel& model, Regions& regions) {
  tbb::enumerable_thread_specific<std::vector<Contact>> found;
  forLeaves(tree.size(), [&](Id leaf) {
    if (tree.cut[leaf]) addContacts(tree, model, regions.ofLeaf, leaf, found.local());
  });
  std::vector<Contact> contacts;
  for (const auto& mine : found) contacts.insert(contacts.end(), mine.begin(), mine.end());
  tbb::parallel_sort(contacts.begin(), contacts.end());
  contacts.erase(std::unique(contacts.begin(), contacts.end()), contacts.end());
  for (Contact c : contacts) regions.list[c >> 32].patches.push_back(static_cast<Id>(c & 0xffffffffu));
}

}  // namespace

std::vector<Id> connectedLeaves(const Octree& tree, const std::vector<std::uint8_t>& member) {
  DisjointSets sets(tree.size());
  forLeaves(tree.size(), [&](Id leaf) {
    if (!member[leaf]) return;
    std::array<Id, 4> n;
    // Looking up from every leaf finds each common face once.
    for (int side = 1; side < 6; side += 2)
      for (int k = tree.faceNeighbours(leaf, side, n); k-- > 0;)
        if (member[n[k]]) sets.join(leaf, n[k]);
  });
  std::vector<Id> number(tree.size(), kNone);
  Id count = 0;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (!member[leaf]) continue;
    const Id root = sets.root(leaf);
    number[leaf] = root == leaf ? count++ : number[root];
  }
  return number;
}

Regions findRegions(const Octree& tree, const SurfaceModel& model) {
  std::vector<std::uint8_t> free(tree.size());
  forLeaves(tree.size(), [&](Id leaf) { free[leaf] = !tree.cut[leaf]; });
  Regions regions;
  regions.ofLeaf = connectedLeaves(tree, free);
  joinThinPlaces(tree, model, regions.ofLeaf);
  std::vector<Tally> tallies;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    const Id id = regions.ofLeaf[leaf];
    if (id == kNone) continue;
    if (id == static_cast<Id>(tallies.size())) tallies.emplace_back();
    tallies[id].add(tree, leaf);
  }
  std::vector<Id> order(tallies.size()), rank(tallies.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Id a, Id b) { return tallies[a].volume > tallies[b].volume; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = static_cast<Id>(i);
    regions.list.push_back(describe(tree, tallies[order[i]]));
  }
  forLeaves(tree.size(), [&](Id leaf) {
    Id& id = regions.ofLeaf[leaf];
    if (id != kNone) id = rank[id];
  });
  findPatches(tree, model, regions);
  return regions;
}

void listTriangles(Octree& tree, const SurfaceModel& model) {
  if (!tree.triangles.values.empty()) return;
  std::vector<std::vector<Id>> rows((tree.size() + 1023) / 1024);
  std::vector<Id> count(tree.size() + 1, 0);
  tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t block) {
    const Id first = static_cast<Id>(1024 * block), last = std::min<Id>(first + 1024, tree.size());
    for (Id leaf = first; leaf < last; ++leaf) {
      if (!tree.cut[leaf]) continue;
      const double slack = touchSlack(tree.brick, std::max(0, tree.levels[leaf] - 1));
      const Box box = tree.box(leaf);
      Box near = box;
      near.lo.array() -= slack;
      near.hi.array() += slack;
      for (Id t : model.trianglesNear(near)) {
        if (!touches(box, model.corner(t, 0), model.corner(t, 1), model.corner(t, 2), slack)) continue;
        rows[block].push_back(t);
        ++count[leaf];
      }
    }
  });
  std::exclusive_scan(count.begin(), count.end(), count.begin(), Id(0));
  tree.triangles.offsets = std::move(count);
  tree.triangles.values.clear();
  for (const std::vector<Id>& row : rows)
    tree.triangles.values.insert(tree.triangles.values.end(), row.begin(), row.end());
}

}  // namespace pm
