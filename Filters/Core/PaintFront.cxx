// SPDX-License-Identifier: BSD-3-Clause
#include "PaintFront.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "Clearance.h"
#include "FrontMesh.h"
#include "FrontRepair.h"
#include "LeakPaths.h"

namespace pm {
namespace {

std::string sizeHint(const Octree& tree) {
  return fmt::format("cells of {:.4g} at the surface", tree.brick.edge(tree.brick.maxLevel));
}

/// A refusal that a search for the leak can explain.
struct Leaking : RegionError {
  Leaking(const std::string& sentence, std::vector<Vec3> from, std::vector<Vec3> to = {})
      : RegionError(sentence), inside(std::move(from)), outside(std::move(to)) {}
  std::vector<Vec3> inside, outside;  ///< points on either side of the leak, where known
};

/// How many edges lie on one triangle only, and whether every edge lies on an even number of them: then no
/// way leads from one side of the surface to the other.
struct EdgeCount {
  std::size_t single = 0;
  bool closed = true;
};

EdgeCount countEdges(const SurfaceModel& model) {
  std::vector<std::pair<Id, Id>> edges;
  edges.reserve(3 * model.triangles().size());
  for (const SurfaceModel::Triangle& t : model.triangles())
    for (int k = 0; k < 3; ++k)
      if (t[k] != t[(k + 1) % 3]) edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
  std::sort(edges.begin(), edges.end());
  EdgeCount count;
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    count.single += next - i == 1;
    count.closed = count.closed && (next - i) % 2 == 0;
  }
  return count;
}

[[noreturn]] void refuseOpen(const Octree& tree, const SurfaceModel& model) {
  const EdgeCount edges = countEdges(model);
  if (edges.closed)
    throw RegionError(
        fmt::format("The geometry encloses nothing with {}: it is closed, but too thin everywhere for a cell "
                    "to fit inside. Use a smaller feature size, or mesh the outside.",
                    sizeHint(tree)));
  throw Leaking(
      fmt::format("The geometry encloses nothing with {}: it leaks through a hole larger than a cell, or "
                  "is too thin for a cell to fit inside; {} of its edges lie on one triangle only. Use a "
                  "larger or a smaller feature size, close the hole, or mesh the outside.",
                  sizeHint(tree), edges.single),
      {});
}

// Regions come largest first.
std::vector<std::uint8_t> chooseEnclosed(const Octree& tree, const SurfaceModel& model,
                                         const Regions& regions, bool all) {
  std::vector<std::uint8_t> chosen(regions.list.size(), 0);
  bool any = false;
  for (std::size_t r = 0; r < chosen.size() && (all || !any); ++r) {
    chosen[r] = !regions.list[r].open;
    any = any || chosen[r] != 0;
  }
  if (!any) refuseOpen(tree, model);
  return chosen;
}

void refuseLeak(const Octree& tree, const PaintedRegion& region, const PaintFrontOptions& options,
                const std::string& which, const std::vector<Vec3>& inside) {
  if (!region.open || tree.brick.sidesArePatches || options.allowOpen) return;
  throw Leaking(
      fmt::format(
          "{} leaks: with {} it reaches the sides of the box around the geometry through a hole larger "
          "than a cell. Use a larger feature size or close the hole.",
          which, sizeHint(tree)),
      inside);
}

std::vector<std::uint8_t> chooseByPoints(const Octree& tree, const Regions& regions,
                                         const PaintFrontOptions& options) {
  std::vector<std::uint8_t> chosen(regions.list.size(), 0);
  if (options.points.empty()) throw InputError("Choosing regions by points needs at least one point.");
  for (const Vec3& p : options.points) {
    const std::string where = fmt::format("point ({:g}, {:g}, {:g})", p[0], p[1], p[2]);
    const Id leaf = tree.locate(p);
    if (leaf == kNone)
      throw RegionError("The " + where + " lies outside the domain; give one within the meshed box.");
    const Id id = regions.ofLeaf[leaf];
    if (id == kNone)
      throw RegionError("The " + where +
                        " lies in a cell that touches the geometry; move it away from the surface, or use a "
                        "smaller feature size.");
    refuseLeak(tree, regions.list[id], options, "The region of the " + where, {p});
    chosen[id] = 1;
  }
  return chosen;
}

std::vector<std::uint8_t> chooseByIds(const Octree& tree, const Regions& regions,
                                      const PaintFrontOptions& options) {
  std::vector<std::uint8_t> chosen(regions.list.size(), 0);
  if (options.ids.empty()) throw InputError("Choosing regions by id needs at least one id.");
  for (Id id : options.ids) {
    if (id < 0 || id >= static_cast<Id>(regions.list.size()))
      throw RegionError(fmt::format("There is no region {}: {} were found with {}, numbered from 0.", id,
                                    regions.list.size(), sizeHint(tree)));
    refuseLeak(tree, regions.list[id], options, fmt::format("Region {}", id), {});
    chosen[id] = 1;
  }
  return chosen;
}

std::vector<std::uint8_t> chooseByPatches(const SurfaceModel& model, const Regions& regions,
                                          const PaintFrontOptions& options) {
  std::vector<std::uint8_t> chosen(regions.list.size(), 0), wanted(model.patchNames().size(), 0);
  if (options.patches.empty()) throw InputError("Choosing regions by patch needs the name of a patch.");
  for (const std::string& name : options.patches) {
    const auto found = std::find(model.patchNames().begin(), model.patchNames().end(), name);
    if (found == model.patchNames().end())
      throw InputError(fmt::format("The geometry has no patch named {}; its patches are: {}.", name,
                                   fmt::join(model.patchNames(), ", ")));
    wanted[found - model.patchNames().begin()] = 1;
  }
  bool any = false;
  for (std::size_t r = 0; r < chosen.size(); ++r) {
    const PaintedRegion& region = regions.list[r];
    chosen[r] = !region.open && std::any_of(region.patches.begin(), region.patches.end(),
                                            [&](Id patch) { return wanted[patch] != 0; });
    any = any || chosen[r];
  }
  if (!any)
    throw RegionError(
        fmt::format("No enclosed region touches {}: choose regions by id or by point, or close "
                    "the holes.",
                    fmt::join(options.patches, " or ")));
  return chosen;
}

// The outside holds the domain's corners. What merely touches a side (the inside of a wheel that pokes
// through the ground) does not count, unless the geometry covers every corner; then the largest open region
// is meant.
std::vector<std::uint8_t> chooseOutside(const Octree& tree, const Regions& regions) {
  std::vector<std::uint8_t> chosen(regions.list.size(), 0);
  bool any = false;
  for (int k = 0; k < 8; ++k) {
    Coord c;
    for (int a = 0; a < 3; ++a) c[a] = (k >> a & 1) ? tree.brick.extent(a) - 1 : 0;
    const Id region = regions.ofLeaf[tree.find(c)];
    if (region == kNone) continue;
    chosen[region] = 1;
    any = true;
  }
  if (any) return chosen;
  for (std::size_t r = 0; r < chosen.size() && !any; ++r) {
    chosen[r] = regions.list[r].open;
    any = chosen[r] != 0;
  }
  if (!any)
    throw RegionError(
        "Nothing reaches the sides of the domain: the geometry fills it. Give a larger domain, or mesh the "
        "inside.");
  return chosen;
}

std::vector<std::uint8_t> choose(const Octree& tree, const SurfaceModel& model, const Regions& regions,
                                 const PaintFrontOptions& options) {
  switch (options.region) {
    case Region::Inside:
      return chooseEnclosed(tree, model, regions, false);
    case Region::Enclosed:
      return chooseEnclosed(tree, model, regions, true);
    case Region::Outside:
      return chooseOutside(tree, regions);
    case Region::Points:
      return chooseByPoints(tree, regions, options);
    case Region::Ids:
      return chooseByIds(tree, regions, options);
    case Region::Patches:
      return chooseByPatches(model, regions, options);
    case Region::Everything:
      break;
  }
  return std::vector<std::uint8_t>(regions.list.size(), 1);
}

// What the user wants kept out and the region holds nevertheless is reached through a leak.
void refuseKeptOut(const Octree& tree, const Regions& regions, const std::vector<std::uint8_t>& chosen,
                   const PaintFrontOptions& options) {
  for (const Vec3& p : options.keepOut) {
    const Id leaf = tree.locate(p);
    const Id id = leaf == kNone ? kNone : regions.ofLeaf[leaf];
    if (id == kNone || !chosen[id]) continue;
    const std::string sentence = fmt::format(
        "The region leaks: with {} it reaches the point ({:g}, {:g}, {:g}), which is to be kept out, through "
        "a hole larger than a cell. Use a larger feature size or close the hole.",
        sizeHint(tree), p[0], p[1], p[2]);
    if (regions.list[id].open) throw Leaking(sentence, {p});
    Vec3 from = regions.list[id].point;
    if (options.region == Region::Points)
      for (const Vec3& q : options.points)
        if (regions.ofLeaf[tree.locate(q)] == id) from = q;
    throw Leaking(sentence, {from}, {p});
  }
}

// A leak is shown with its place, not only stated; and a small cavity is not taken for the domain without a
// word.
std::vector<std::uint8_t> chooseOrExplain(const Octree& tree, const SurfaceModel& model,
                                          const Regions& regions, const PaintFrontOptions& options,
                                          Monitor& monitor) {
  std::vector<std::uint8_t> chosen;
  try {
    chosen = choose(tree, model, regions, options);
    refuseKeptOut(tree, regions, chosen, options);
  } catch (const Leaking& leak) {
    throwLeak(leak.what(), tree, model, leak.inside, leak.outside, monitor);
  }
  if (options.region == Region::Inside)
    for (std::size_t r = 0; r < chosen.size(); ++r)
      if (chosen[r]) warnOfLargerRoom(regions.list[r].volume, tree, model, monitor);
  return chosen;
}

// Where the domain surely is: at the given points, or at the corners of the outside.
std::vector<Id> homeLeaves(const Octree& tree, const PaintFrontOptions& options) {
  if (options.region == Region::Outside) return outsideLeaves(tree, {});
  return options.region == Region::Points ? outsideLeaves(tree, options.points) : std::vector<Id>{};
}

// Repair can cut a thin neck; what hangs on it alone would be a mesh of its own, so each region keeps its
// largest part.
void dropIslands(const Octree& tree, const Regions& regions, std::vector<std::uint8_t>& painted) {
  const std::vector<Id> part = connectedLeaves(tree, painted);
  const Id parts = part.empty() ? 0 : *std::max_element(part.begin(), part.end()) + 1;
  std::vector<Id> home(parts, kNone), largest(regions.list.size(), kNone);
  std::vector<Key> volume(parts, 0);  // in finest cells
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (!painted[leaf]) continue;
    volume[part[leaf]] += Key(1) << (3 * (tree.brick.maxLevel - tree.levels[leaf]));
    if (!tree.cut[leaf]) home[part[leaf]] = regions.ofLeaf[leaf];
  }
  for (Id p = 0; p < parts; ++p)
    if (home[p] != kNone && (largest[home[p]] == kNone || volume[p] > volume[largest[home[p]]]))
      largest[home[p]] = p;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (painted[leaf]) painted[leaf] = home[part[leaf]] != kNone && largest[home[part[leaf]]] == part[leaf];
}

// A region named by the user that repair has taken away altogether; of all those found some may be tiny.
void warnOfLost(const std::vector<PaintedRegion>& regions, const std::vector<std::uint8_t>& chosen,
                const PaintFrontOptions& options, Monitor& monitor) {
  if (options.region == Region::Enclosed || options.region == Region::Everything) return;
  for (std::size_t r = 0; r < chosen.size(); ++r)
    if (chosen[r] && !regions[r].chosen)
      monitor.warning(
          fmt::format("Region {} is too narrow for its cells and is not in the mesh: none was left "
                      "after repairing the front. Use a smaller feature size.",
                      r));
}

// A zone has the name of its region's patch where that patch is the region's own, else its number.
void nameZones(const std::vector<PaintedRegion>& regions, const std::vector<Id>& regionOfCell,
               PolyMesh& mesh) {
  std::vector<Id> zoneOf(regions.size(), kNone), users(mesh.patchNames.size(), 0);
  Id zones = 0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!regions[r].chosen) continue;
    zoneOf[r] = zones++;
    for (Id patch : regions[r].patches) ++users[patch];
  }
  if (zones < 2) return;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!regions[r].chosen) continue;
    const std::vector<Id>& patches = regions[r].patches;
    const bool own = patches.size() == 1 && users[patches[0]] == 1;
    mesh.zoneNames.push_back(own ? mesh.patchNames[patches[0]] : fmt::format("region_{}", r));
  }
  mesh.zone.resize(regionOfCell.size());
  for (std::size_t c = 0; c < regionOfCell.size(); ++c) mesh.zone[c] = zoneOf[regionOfCell[c]];
}

void noteInvisible(const NarrowPassages& invisible, const Octree& tree, std::vector<std::string>& notes) {
  if (invisible.places.empty()) return;
  const NarrowPlace& largest = invisible.places.front();
  notes.push_back(fmt::format(
      "The mesh leaves out {} of the domain too narrow for {}, {} cells in all. The largest, about ({:.6g}, "
      "{:.6g}, {:.6g}), is {:.4g} wide; a feature size of {:.4g} would show it.",
      invisible.places.size() == 1 ? "a place" : fmt::format("{} places", invisible.places.size()),
      sizeHint(tree), invisible.cells.size(), largest.centre[0], largest.centre[1], largest.centre[2],
      largest.median, largest.featureSize));
}

// Inside takes the largest enclosed region alone: of several bodies, or of one that thin places cut in two,
// the others are missed without a word.
void noteOthers(const std::vector<PaintedRegion>& regions, const Octree& tree,
                std::vector<std::string>& notes) {
  constexpr double little = 0.1;
  double meshed = 0, others = 0;
  Id count = 0;
  for (const PaintedRegion& region : regions) {
    if (region.open) continue;
    (region.chosen ? meshed : others) += region.volume;
    count += region.chosen ? 0 : 1;
  }
  if (others <= little * meshed) return;
  notes.push_back(
      fmt::format("Of the volume that the geometry encloses with {}, {:.0f}% is in the mesh; {} not. Region "
                  "Enclosed meshes "
                  "all, and a smaller feature size joins what only thin places part.",
                  sizeHint(tree), 100 * meshed / (meshed + others),
                  count == 1 ? "another region is" : fmt::format("{} other regions are", count)));
}

// Filling, then the repair of what is no permitted pattern, then whole regions only.
void repairFront(const Octree& tree, const SurfaceModel& model, const PaintFrontOptions& options,
                 Regions& regions, std::vector<std::uint8_t>& painted, Monitor& monitor,
                 PaintFrontReport& report) {
  FrontRepair repair(tree, model, painted, regions.ofLeaf);
  if (options.fill) {
    constexpr int kFillRounds = 4;  // each round may open one more cell of a narrowing gap
    for (int round = 0; round < kFillRounds; ++round) {
      const Id filled = repair.fill();
      report.filled += filled;
      if (filled == 0) break;
    }
  }
  repair.clean(monitor, report);
  dropIslands(tree, regions, painted);
}

}  // namespace

PolyMesh paintFront(const Octree& tree, const SurfaceModel& model, const PaintFrontOptions& options,
                    Monitor& monitor, PaintFrontReport* report) {
  PaintFrontReport local;
  PaintFrontReport& r = report ? *report : local;
  r = {};

  monitor.check(0, "painting");
  Regions regions = findRegions(tree, model);
  const std::vector<std::uint8_t> chosen = chooseOrExplain(tree, model, regions, options, monitor);
  if (options.reportLeaks) {
    r.leaked = findRoomLeaks(tree, model, regions, chosen, homeLeaves(tree, options), monitor);
    if (!r.leaked.rooms.empty()) monitor.warning(describe(r.leaked));
  }
  std::vector<std::uint8_t> painted(tree.size(), 0);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    const Id id = regions.ofLeaf[leaf];
    painted[leaf] = id != kNone && chosen[id];
  }

  monitor.check(0.3, "front filling");
  repairFront(tree, model, options, regions, painted, monitor, r);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (!painted[leaf]) continue;
    r.regionOfCell.push_back(regions.ofLeaf[leaf]);
    regions.list[regions.ofLeaf[leaf]].chosen = true;
  }
  r.chosenCells = static_cast<Id>(r.regionOfCell.size());
  if (r.chosenCells == 0)
    throw RegionError(
        fmt::format("The region is too narrow for {}: no cell is left after repairing the front. Use a "
                    "smaller feature size.",
                    sizeHint(tree)));
  if (options.reportInvisible && report) {
    r.invisible = findNarrowPassages(tree, model, painted, regions, monitor);
    noteInvisible(r.invisible, tree, r.notes);
  }
  r.regions = std::move(regions.list);
  warnOfLost(r.regions, chosen, options, monitor);
  if (options.region == Region::Inside) noteOthers(r.regions, tree, r.notes);
  monitor.check(0.85, "front mesh");
  PolyMesh mesh = frontMesh(tree, painted, model);
  nameZones(r.regions, r.regionOfCell, mesh);
  r.painted = std::move(painted);
  return mesh;
}

}  // namespace pm
