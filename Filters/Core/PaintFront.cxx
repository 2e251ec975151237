// SPDX-License-Identifier: BSD-3-Clause
#include "PaintFront.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "FrontMesh.h"
#include "FrontRepair.h"

namespace pm {
namespace {

/// Face-connected sets of leaves for which `member` holds: a number for each leaf, kNone for the others.
template <class Member>
std::vector<Id> components(const Octree& tree, const Member& member, std::vector<PaintedRegion>& regions) {
  std::vector<Id> number(tree.size(), kNone), stack;
  regions.clear();
  for (Id seed = 0; seed < tree.size(); ++seed) {
    if (!member(seed) || number[seed] != kNone) continue;
    const Id id = static_cast<Id>(regions.size());
    PaintedRegion region;
    stack.assign(1, seed);
    number[seed] = id;
    while (!stack.empty()) {
      const Id leaf = stack.back();
      stack.pop_back();
      ++region.cells;
      const Vec3 size = tree.brick.cellSize(tree.levels[leaf]);
      region.volume += size.prod();
      std::array<Id, 4> n;
      for (int side = 0; side < 6; ++side) {
        const int count = tree.faceNeighbours(leaf, side, n);
        region.open = region.open || count == 0;
        for (int k = 0; k < count; ++k)
          if (member(n[k]) && number[n[k]] == kNone) {
            number[n[k]] = id;
            stack.push_back(n[k]);
          }
      }
    }
    regions.push_back(region);
  }
  return number;
}

std::string sizeHint(const Octree& tree) {
  return fmt::format("cells of {:.4g} at the surface", tree.brick.edge(tree.brick.maxLevel));
}

std::vector<std::uint8_t> chooseInside(const Octree& tree, const std::vector<PaintedRegion>& regions) {
  std::vector<std::uint8_t> chosen(regions.size(), 0);
  Id best = kNone;
  for (Id r = 0; r < static_cast<Id>(regions.size()); ++r)
    if (!regions[r].open && (best == kNone || regions[r].volume > regions[best].volume)) best = r;
  if (best == kNone)
    throw RegionError(
        fmt::format("The geometry encloses nothing with {}: it leaks through a hole larger than a cell, or "
                    "is too thin for a cell to fit inside. Use a larger or a smaller feature size, close "
                    "the hole, or mesh the outside.",
                    sizeHint(tree)));
  chosen[best] = 1;
  return chosen;
}

std::vector<std::uint8_t> chooseByPoints(const Octree& tree, const std::vector<PaintedRegion>& regions,
                                         const std::vector<Id>& number, const PaintFrontOptions& options) {
  std::vector<std::uint8_t> chosen(regions.size(), 0);
  if (options.points.empty()) throw InputError("Choosing regions by points needs at least one point.");
  for (const Vec3& p : options.points) {
    const std::string where = fmt::format("The point ({:g}, {:g}, {:g})", p[0], p[1], p[2]);
    const Id leaf = tree.locate(p);
    if (leaf == kNone) throw RegionError(where + " lies outside the domain; give one within the meshed box.");
    if (number[leaf] == kNone)
      throw RegionError(where +
                        " lies in a cell that touches the geometry; move it away from the surface, or use a "
                        "smaller feature size.");
    if (regions[number[leaf]].open && !tree.brick.sidesArePatches && !options.allowOpen)
      throw RegionError(
          fmt::format("The region of {} leaks: with {} it reaches the sides of the box around the geometry "
                      "through a hole larger than a cell. Use a larger feature size or close the hole.",
                      "the p" + where.substr(5), sizeHint(tree)));
    chosen[number[leaf]] = 1;
  }
  return chosen;
}

// The outside holds the domain's corners. What merely touches a side (the inside of a wheel that pokes
// through the ground) does not count, unless the geometry covers every corner; then the largest open region
// is meant.
std::vector<std::uint8_t> chooseOutside(const Octree& tree, const std::vector<PaintedRegion>& regions,
                                        const std::vector<Id>& number) {
  std::vector<std::uint8_t> chosen(regions.size(), 0);
  bool any = false;
  for (int k = 0; k < 8; ++k) {
    Coord c;
    for (int a = 0; a < 3; ++a) c[a] = (k >> a & 1) ? tree.brick.extent(a) - 1 : 0;
    const Id region = number[tree.find(c)];
    if (region != kNone) any = chosen[region] = true;
  }
  if (any) return chosen;
  Id best = kNone;
  for (Id r = 0; r < static_cast<Id>(regions.size()); ++r)
    if (regions[r].open && (best == kNone || regions[r].volume > regions[best].volume)) best = r;
  if (best == kNone)
    throw RegionError(
        "Nothing reaches the sides of the domain: the geometry fills it. Give a larger domain, or mesh the "
        "inside.");
  chosen[best] = 1;
  return chosen;
}

// Repair can cut a thin neck; what hangs on it alone would be a mesh of its own, so each region keeps its
// largest part.
void dropIslands(const Octree& tree, const std::vector<Id>& region, std::vector<std::uint8_t>& painted) {
  std::vector<PaintedRegion> parts;
  const std::vector<Id> part = components(
      tree, [&](Id leaf) { return painted[leaf] != 0; }, parts);
  std::vector<Id> home(parts.size(), kNone), largest;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (painted[leaf] && region[leaf] != kNone) home[part[leaf]] = region[leaf];
  largest.assign(region.empty() ? 0 : *std::max_element(region.begin(), region.end()) + 1, kNone);
  for (Id p = 0; p < static_cast<Id>(parts.size()); ++p)
    if (home[p] != kNone && (largest[home[p]] == kNone || parts[p].volume > parts[largest[home[p]]].volume))
      largest[home[p]] = p;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (painted[leaf]) painted[leaf] = home[part[leaf]] != kNone && largest[home[part[leaf]]] == part[leaf];
}

}  // namespace

PolyMesh paintFront(const Octree& tree, const SurfaceModel& model, const PaintFrontOptions& options,
                    Monitor& monitor, PaintFrontReport* report) {
  PaintFrontReport local;
  PaintFrontReport& r = report ? *report : local;
  r = {};

  monitor.check(0, "painting");
  const std::vector<Id> number = components(
      tree, [&](Id leaf) { return !tree.cut[leaf]; }, r.regions);
  const std::vector<std::uint8_t> chosen = options.region == Region::Inside ? chooseInside(tree, r.regions)
                                           : options.region == Region::Outside
                                               ? chooseOutside(tree, r.regions, number)
                                               : chooseByPoints(tree, r.regions, number, options);
  std::vector<std::uint8_t> painted(tree.size(), 0);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) painted[leaf] = number[leaf] != kNone && chosen[number[leaf]];

  monitor.check(0.3, "front filling");
  FrontRepair repair(tree, model, painted);
  if (options.fill) {
    constexpr int kFillRounds = 4;  // each round may open one more cell of a narrowing gap
    for (int round = 0; round < kFillRounds; ++round) {
      const Id filled = repair.fill();
      r.filled += filled;
      if (filled == 0) break;
    }
  }
  repair.clean(monitor, r);
  dropIslands(tree, number, painted);
  r.chosenCells = static_cast<Id>(std::count(painted.begin(), painted.end(), 1));
  if (r.chosenCells == 0)
    throw RegionError(
        fmt::format("The region is too narrow for {}: no cell is left after repairing the front. Use a "
                    "smaller feature size.",
                    sizeHint(tree)));
  std::stable_sort(r.regions.begin(), r.regions.end(),
                   [](const PaintedRegion& a, const PaintedRegion& b) { return a.volume > b.volume; });
  monitor.check(0.85, "front mesh");
  return frontMesh(tree, painted, model);
}

}  // namespace pm
