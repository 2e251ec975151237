// SPDX-License-Identifier: BSD-3-Clause
#include "LeakedRooms.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "DisjointSets.h"

namespace pm {
namespace {

constexpr double kSmallest = 1e-4;  // of the volume of the geometry's box: smaller rooms are left alone

/// Level of the smallest cell that holds both keys; -1 in different root cells.
int commonLevel(const Brick& brick, Key a, Key b) {
  int level = brick.maxLevel;
  for (Key different = a ^ b; different != 0; different >>= 3) --level;
  return std::max(level, -1);
}

/// Largest aligned cubes without a cut leaf, in Morton order.
struct OpenCells {
  std::vector<Key> keys;                     // #O
  std::vector<std::uint8_t> levels;          // #O
  std::vector<Id> firstLeaf;                 // #O
  std::vector<Id> ofLeaf;                    // #L kNone for a leaf that is cut or not asked for
  std::vector<std::array<Id, 6>> neighbour;  // #O at most as fine as the cell itself, kNone = none
  std::vector<std::uint8_t> order;           // #O when they join: by size, first those among open space
  Id size() const { return static_cast<Id>(keys.size()); }
};

/// Are all cells of the same size around a cell open? Then what passes there is three cells wide.
bool isAmongOpen(const Octree& tree, const OpenCells& cells, Id c) {
  const Coord corner = decode(cells.keys[c]);
  const std::int32_t span = tree.brick.span(cells.levels[c]);
  for (int k = 0; k < 27; ++k) {
    const Coord q{corner[0] + (k % 3 - 1) * span, corner[1] + (k / 3 % 3 - 1) * span,
                  corner[2] + (k / 9 - 1) * span};
    if (!tree.brick.inside(q)) continue;
    const Id other = cells.ofLeaf[tree.find(q)];
    if (other == kNone || cells.levels[other] > cells.levels[c]) return false;
  }
  return true;
}

OpenCells findOpenCells(const Octree& tree, const std::vector<std::uint8_t>& wanted) {
  OpenCells cells;
  cells.ofLeaf.assign(tree.size(), kNone);
  Id before = kNone, after = 0;  // nearest cut leaves
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (tree.cut[leaf]) before = leaf;
    if (!wanted[leaf]) continue;
    for (after = std::max(after, leaf); after < tree.size() && !tree.cut[after];) ++after;
    int level = 0;
    if (before != kNone)
      level = std::max(level, 1 + commonLevel(tree.brick, tree.keys[before], tree.keys[leaf]));
    if (after < tree.size())
      level = std::max(level, 1 + commonLevel(tree.brick, tree.keys[leaf], tree.keys[after]));
    const int below = 3 * (tree.brick.maxLevel - level);
    const Key key = tree.keys[leaf] >> below << below;
    if (cells.keys.empty() || cells.keys.back() != key) {
      cells.keys.push_back(key);
      cells.levels.push_back(static_cast<std::uint8_t>(level));
      cells.firstLeaf.push_back(leaf);
    }
    cells.ofLeaf[leaf] = cells.size() - 1;
  }
  cells.neighbour.resize(cells.size());
  cells.order.resize(cells.size());
  tbb::parallel_for(Id(0), cells.size(), [&](Id c) {
    const Coord corner = decode(cells.keys[c]);
    const std::int32_t span = tree.brick.span(cells.levels[c]);
    for (int side = 0; side < 6; ++side) {
      Coord beyond = corner;
      beyond[side / 2] += side % 2 ? span : -1;
      Id& n = cells.neighbour[c][side] = kNone;
      if (!tree.brick.inside(beyond)) continue;
      const Id other = cells.ofLeaf[tree.find(beyond)];
      if (other != kNone && cells.levels[other] <= cells.levels[c]) n = other;
    }
    cells.order[c] = static_cast<std::uint8_t>(2 * cells.levels[c] + !isAmongOpen(tree, cells, c));
  });
  return cells;
}

/// Edge of the leaf that the closest geometry lies in.
double cellAtRim(const Octree& tree, const SurfaceModel& model, const Vec3& place) {
  const Id leaf = tree.locate(model.closest(place).point);
  return tree.brick.edge(leaf == kNone ? tree.brick.maxLevel : tree.levels[leaf]);
}

bool isConvincing(const LeakedRoom& room) {
  return room.width >= LeakedRoom::kRoomy * room.opening && room.opening <= LeakedRoom::kHandful * room.cell;
}

/// Open cells that hang together.
struct Part {
  Id root;
  Id peak;     // the largest cell, the first of several
  Key volume;  // in finest cells
  Id region;
  bool main = false;
};

class RoomSearch {
 public:
  RoomSearch(const Octree& tree, const SurfaceModel& model, const Regions& regions,
             const std::vector<std::uint8_t>& wanted, const std::vector<Id>& home, Monitor& monitor)
      : tree_(tree),
        model_(model),
        regions_(regions),
        home_(home),
        monitor_(monitor),
        cells_(findOpenCells(tree, wanted)),
        sets_(cells_.size()),
        partOf_(cells_.size(), kNone) {}

  LeakedRooms run() {
    std::vector<std::vector<Id>> inOrder(2 * tree_.brick.maxLevel + 2);
    for (Id c = 0; c < cells_.size(); ++c) inOrder[cells_.order[c]].push_back(c);
    for (const std::vector<Id>& fresh : inOrder) {
      monitor_.check(0.9, "rooms behind narrow openings");
      if (!fresh.empty()) step(cells_.levels[fresh[0]], fresh);
    }
    std::stable_sort(found_.rooms.begin(), found_.rooms.end(),
                     [](const LeakedRoom& a, const LeakedRoom& b) { return a.volume > b.volume; });
    std::sort(found_.mainLeaves.begin(), found_.mainLeaves.end());
    return std::move(found_);
  }

 private:
  double edge(int level) const { return tree_.brick.edge(level); }
  Vec3 centre(Id cell) const { return tree_.brick.box(cells_.keys[cell], cells_.levels[cell]).centre(); }
  double clearance(const Vec3& p) const { return std::sqrt(model_.closest(p).distance2); }

  /// Cells of this level join what they touch.
  void step(int level, const std::vector<Id>& fresh) {
    markMain();
    before_ = sets_;
    for (Id c : fresh)
      for (Id n : cells_.neighbour[c])
        if (n != kNone && cells_.order[n] <= cells_.order[c]) sets_.join(c, n);
    std::vector<std::uint8_t> joinsMain(cells_.size(), 0);
    for (const Part& part : parts_)
      if (part.main) joinsMain[sets_.root(part.root)] = 1;
    std::vector<Id> late;
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (!parts_[p].main && joinsMain[sets_.root(parts_[p].root)] && mayBeRoom(parts_[p], level))
        late.push_back(static_cast<Id>(p));
    if (!late.empty()) measure(late, fresh);
    mergeParts(level, fresh);
  }

  /// The main part of a region holds one of the leaves of home, or is the largest.
  void markMain() {
    std::vector<Id> largest(regions_.list.size(), kNone);
    for (Part& part : parts_) part.main = false;
    for (Id leaf : home_) {
      const Id cell = cells_.ofLeaf[leaf];
      const Id part = cell == kNone ? kNone : partOf_[sets_.root(cell)];
      if (part == kNone) continue;
      parts_[part].main = true;
      largest[parts_[part].region] = part;
    }
    const std::vector<Id> given = largest;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      Id& best = largest[parts_[p].region];
      if (given[parts_[p].region] == kNone && (best == kNone || parts_[p].volume > parts_[best].volume))
        best = static_cast<Id>(p);
    }
    for (Id part : largest)
      if (part != kNone) parts_[part].main = true;
  }

  void mergeParts(int level, const std::vector<Id>& fresh) {
    const Key cube = Key(1) << (3 * (tree_.brick.maxLevel - level));
    std::vector<Part> old = std::move(parts_);
    parts_.clear();
    for (const Part& part : old) partOf_[part.root] = kNone;
    const auto add = [&](const Part& piece) {
      const Id root = sets_.root(piece.root);
      if (partOf_[root] == kNone) {
        partOf_[root] = static_cast<Id>(parts_.size());
        parts_.push_back(piece);
        parts_.back().root = root;
        return;
      }
      Part& whole = parts_[partOf_[root]];
      whole.volume += piece.volume;
      if (std::pair(cells_.levels[piece.peak], piece.peak) < std::pair(cells_.levels[whole.peak], whole.peak))
        whole.peak = piece.peak;
    };
    for (const Part& part : old) add(part);
    for (Id c : fresh) add({c, c, cube, regions_.ofLeaf[cells_.firstLeaf[c]]});
  }

  double volumeOf(const Part& part) const {
    return double(part.volume) * tree_.brick.cellSize(tree_.brick.maxLevel).prod();
  }

  /// Cells of this level get in, so the opening is at least that wide.
  bool mayBeRoom(const Part& part, int level) {
    if (volumeOf(part) < kSmallest * model_.bounds().size().prod()) return false;
    return 2 * clearance(widest(part)) >= LeakedRoom::kRoomy * edge(level);
  }

  /// Of a main part, or of none that may be a room.
  bool isMain(Id leaf) {
    const Id cell = leaf == kNone ? kNone : cells_.ofLeaf[leaf];
    const Id part = cell == kNone ? kNone : partBefore(cell);
    return cell == kNone || (part != kNone && parts_[part].main);
  }

  /// Climbs from the peak to where the room is widest around; each step stays in the empty ball of the last.
  Vec3 widest(const Part& part) {
    Vec3 p = centre(part.peak);
    double best = clearance(p);
    for (double step = edge(cells_.levels[part.peak]); step > 0.1 * best;) {
      const Vec3 here = p;
      for (int k = 0; k < 6; ++k) {
        Vec3 q = here;
        q[k / 2] += (k % 2 ? 1 : -1) * std::min(step, 0.9 * best);
        const double c = isMain(tree_.locate(q)) ? 0 : clearance(q);
        if (c > best) best = c, p = q;
      }
      if (p == here) step *= 0.5;
    }
    return p;
  }

  /// A cell in the shell between parts.
  struct Wave {
    double width;
    Id cell;
    bool operator<(const Wave& o) const { return width != o.width ? width < o.width : cell > o.cell; }
  };

  /// Fresh cells beside each part of the last step, as sorted pairs (part, cell).
  using Shells = std::vector<std::pair<Id, Id>>;
  Shells shellsOf(const std::vector<Id>& fresh) {
    Shells shells;
    for (Id c : fresh)
      for (Id n : cells_.neighbour[c])
        if (n != kNone && partBefore(n) != kNone) shells.push_back({partBefore(n), c});
    sortUnique(shells);
    return shells;
  }
  Id partBefore(Id cell) { return partOf_[before_.root(cell)]; }

  /// The widest ways from these parts through fresh cells, and perhaps other parts, to a main one.
  void measure(const std::vector<Id>& late, const std::vector<Id>& fresh) {
    const Shells shells = shellsOf(fresh);
    for (Id part : late) {
      monitor_.check(0.9, "rooms behind narrow openings");
      LeakedRoom room;
      room.region = parts_[part].region;
      room.point = widest(parts_[part]);
      room.width = 2 * clearance(room.point);
      room.volume = volumeOf(parts_[part]);
      flood(part, shells, room);
      if (isConvincing(room)) remember(room);
    }
  }

  /// Parts behind the same opening are one room.
  void remember(const LeakedRoom& room) {
    for (LeakedRoom& known : found_.rooms)
      if (known.region == room.region && known.place == room.place) {
        known.volume += room.volume;
        if (room.width > known.width) std::tie(known.point, known.width) = std::tie(room.point, room.width);
        return;
      }
    const bool first = std::none_of(found_.rooms.begin(), found_.rooms.end(),
                                    [&](const LeakedRoom& r) { return r.region == room.region; });
    found_.rooms.push_back(room);
    for (Id leaf = 0; first && leaf < tree_.size(); ++leaf) {
      const Id part = cells_.ofLeaf[leaf] == kNone ? kNone : partBefore(cells_.ofLeaf[leaf]);
      if (part != kNone && parts_[part].main && parts_[part].region == room.region)
        found_.mainLeaves.push_back(leaf);
    }
  }

  void flood(Id start, const Shells& shells, LeakedRoom& room) {
    std::priority_queue<Wave> heap;
    std::vector<std::uint8_t> partSeen(parts_.size(), 0), cellSeen(cells_.size(), 0);
    const auto enter = [&](Id cell) {
      if (std::exchange(cellSeen[cell], 1) == 0) heap.push({clearance(centre(cell)), cell});
    };
    const auto leave = [&](Id part) {
      if (std::exchange(partSeen[part], 1)) return;
      for (auto at = std::lower_bound(shells.begin(), shells.end(), std::pair(part, Id(0)));
           at != shells.end() && at->first == part; ++at)
        enter(at->second);
    };
    double narrowest = std::numeric_limits<double>::infinity();
    leave(start);
    while (!heap.empty()) {
      const Wave next = heap.top();
      heap.pop();
      if (next.width < narrowest) {
        narrowest = next.width;
        room.place = centre(next.cell);
      }
      for (Id n : cells_.neighbour[next.cell]) {
        if (n == kNone || cells_.order[n] > cells_.order[next.cell]) continue;
        const Id part = partBefore(n);
        if (part == kNone) {
          enter(n);
        } else if (parts_[part].main) {
          room.opening = 2 * narrowest;
          room.cell = cellAtRim(tree_, model_, room.place);
          return;
        } else {
          leave(part);
        }
      }
    }
  }

  const Octree& tree_;
  const SurfaceModel& model_;
  const Regions& regions_;
  const std::vector<Id>& home_;
  Monitor& monitor_;
  const OpenCells cells_;
  DisjointSets sets_, before_{0};
  std::vector<Part> parts_;
  std::vector<Id> partOf_;  // part of each root cell
  LeakedRooms found_;
};

}  // namespace

LeakedRooms findLeakedRooms(const Octree& tree, const SurfaceModel& model, const Regions& regions,
                            const std::vector<std::uint8_t>& chosen, const std::vector<Id>& home,
                            Monitor& monitor) {
  std::vector<std::uint8_t> wanted(tree.size());
  tbb::parallel_for(Id(0), tree.size(),
                    [&](Id leaf) { wanted[leaf] = !tree.cut[leaf] && chosen[regions.ofLeaf[leaf]]; });
  return RoomSearch(tree, model, regions, wanted, home, monitor).run();
}

RoomLeaks findRoomLeaks(const Octree& tree, const SurfaceModel& model, const Regions& regions,
                        const std::vector<std::uint8_t>& chosen, const std::vector<Id>& home,
                        Monitor& monitor) {
  LeakedRooms suspects = findLeakedRooms(tree, model, regions, chosen, home, monitor);
  RoomLeaks found;
  // Where no point tells, the largest part is the main one, and that may change while the parts grow.
  const auto wasMain = [&](const LeakedRoom& room) {
    return std::binary_search(suspects.mainLeaves.begin(), suspects.mainLeaves.end(),
                              tree.locate(room.point));
  };
  suspects.rooms.erase(std::remove_if(suspects.rooms.begin(), suspects.rooms.end(), wasMain),
                       suspects.rooms.end());
  if (suspects.rooms.empty()) return found;
  LeakOptions options;
  options.outsideLeaves = suspects.mainLeaves;
  for (const LeakedRoom& room : suspects.rooms) options.insidePoints.push_back(room.point);
  std::vector<Leak> leaks = findLeaks(tree, model, options, monitor).leaks;
  for (LeakedRoom room : suspects.rooms) {
    const auto leadsOut = [&](const Leak& leak) { return leak.path.front() == room.point; };
    const auto widest = std::find_if(leaks.begin(), leaks.end(), leadsOut);
    if (widest == leaks.end()) continue;
    room.opening = widest->width;
    room.place = widest->bottleneck;
    room.cell = cellAtRim(tree, model, room.place);
    if (!isConvincing(room)) continue;
    found.rooms.push_back(room);
    for (Leak& leak : leaks)
      if (leadsOut(leak)) found.leaks.push_back(leak);
  }
  std::stable_sort(found.leaks.begin(), found.leaks.end(),
                   [](const Leak& a, const Leak& b) { return a.width > b.width; });
  return found;
}

std::string describe(const RoomLeaks& found) {
  if (found.rooms.empty()) return {};
  const LeakedRoom& room = found.rooms.front();
  return fmt::format(
      "The mesh goes into {} only through narrow openings, {} in all. {}, about ({:.4g}, {:.4g}, {:.4g}), is "
      "{:.4g} wide, and its widest opening, at ({:.4g}, {:.4g}, {:.4g}), {:.4g}: {:.2g} cells. If that is a "
      "leak, close it with Close Holes or use a feature size of {:.4g}, which seals it; a keep-out point in "
      "the room makes leaks an error.",
      found.rooms.size() == 1 ? "a room" : fmt::format("{} rooms", found.rooms.size()), found.leaks.size(),
      found.rooms.size() == 1 ? "The room" : "The largest", room.point[0], room.point[1], room.point[2],
      room.width, room.place[0], room.place[1], room.place[2], room.opening, room.opening / room.cell,
      found.leaks.front().sealingSize);
}

}  // namespace pm
