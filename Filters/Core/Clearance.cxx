// SPDX-License-Identifier: BSD-3-Clause
#include "Clearance.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr Id kBlock = 256;           // leaves in a row that hand on their closest triangle
constexpr Id kLeavesACheck = 65536;  // an abort waits for at most this many

/// Calls visit(neighbour) for each free leaf across the faces of a free leaf.
template <class Visit>
void eachFreeNeighbour(const Octree& tree, Id leaf, const Visit& visit) {
  if (tree.cut[leaf]) return;
  std::array<Id, 4> n;
  for (int side = 0; side < 6; ++side) {
    const int count = tree.faceNeighbours(leaf, side, n);
    for (int k = 0; k < count; ++k)
      if (!tree.cut[n[k]]) visit(n[k]);
  }
}

/// #L 1 = one of the leaves, and so are all its free neighbours.
std::vector<std::uint8_t> deepWithin(const Octree& tree, const std::vector<Id>& leaves) {
  std::vector<std::uint8_t> member(tree.size(), 0), deep(tree.size(), 0);
  for (Id leaf : leaves) member[leaf] = 1;
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    bool all = true;
    eachFreeNeighbour(tree, leaves[i], [&](Id n) { all = all && member[n]; });
    deep[leaves[i]] = all;
  });
  return deep;
}

bool atSide(const Octree& tree, Id leaf) {
  const Coord c = tree.corner(leaf);
  const std::int32_t span = tree.brick.span(tree.levels[leaf]);
  for (int a = 0; a < 3; ++a)
    if (c[a] == 0 || c[a] + span == tree.brick.extent(a)) return true;
  return false;
}

}  // namespace

std::vector<double> leafClearance(const Octree& tree, const SurfaceModel& model, Monitor& monitor,
                                  const std::vector<Id>& known) {
  std::vector<double> clearance(tree.size(), -1);
  const std::vector<std::uint8_t> skip = deepWithin(tree, known);
  for (Id first = 0; first < tree.size(); first += kLeavesACheck) {
    monitor.check(double(first) / tree.size(), "clearance");
    const Id last = std::min(tree.size(), first + kLeavesACheck);
    tbb::parallel_for(Id(0), (last - first + kBlock - 1) / kBlock, [&](Id block) {
      Closest previous;
      for (Id leaf = first + block * kBlock; leaf < std::min(last, first + (block + 1) * kBlock); ++leaf) {
        if (tree.cut[leaf]) continue;
        if (skip[leaf]) {
          clearance[leaf] = 0.5 * tree.brick.edge(tree.levels[leaf]);
          continue;
        }
        previous = model.closest(tree.box(leaf).centre(), previous);
        clearance[leaf] = std::sqrt(previous.distance2);
      }
    });
  }
  return clearance;
}

Csr<Id> freeNeighbours(const Octree& tree) {
  Csr<Id> graph;
  graph.offsets.assign(tree.size() + 1, 0);
  tbb::parallel_for(Id(0), tree.size(),
                    [&](Id leaf) { eachFreeNeighbour(tree, leaf, [&](Id) { ++graph.offsets[leaf + 1]; }); });
  for (Id leaf = 0; leaf < tree.size(); ++leaf) graph.offsets[leaf + 1] += graph.offsets[leaf];
  graph.values.resize(graph.offsets.back());
  tbb::parallel_for(Id(0), tree.size(), [&](Id leaf) {
    Id at = graph.offsets[leaf];
    eachFreeNeighbour(tree, leaf, [&](Id n) { graph.values[at++] = n; });
  });
  return graph;
}

Id freeLeafAt(const Octree& tree, const Vec3& p) {
  const std::string where = fmt::format("The point ({:g}, {:g}, {:g})", p[0], p[1], p[2]);
  const Id leaf = tree.locate(p);
  if (leaf == kNone) throw RegionError(where + " lies outside the domain; give one within the meshed box.");
  if (tree.cut[leaf])
    throw RegionError(where +
                      " lies in a cell that touches the geometry; move it away from the surface, or use a "
                      "smaller feature size.");
  return leaf;
}

std::vector<Id> outsideLeaves(const Octree& tree, const std::vector<Vec3>& points) {
  std::vector<Id> leaves;
  for (const Vec3& p : points) leaves.push_back(freeLeafAt(tree, p));
  if (!leaves.empty()) return leaves;
  for (int k = 0; k < 8; ++k) {
    Coord c;
    for (int a = 0; a < 3; ++a) c[a] = (k >> a & 1) ? tree.brick.extent(a) - 1 : 0;
    const Id leaf = tree.find(c);
    if (!tree.cut[leaf]) leaves.push_back(leaf);
  }
  if (!leaves.empty()) return leaves;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (!tree.cut[leaf] && atSide(tree, leaf)) leaves.push_back(leaf);
  return leaves;
}

}  // namespace pm
