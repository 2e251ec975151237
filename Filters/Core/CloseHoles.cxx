// SPDX-License-Identifier: BSD-3-Clause
#include "CloseHoles.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "OffsetCaps.h"

namespace pm {

const char* const kClosedHolesPatch = "closed_holes";

namespace {

constexpr int kRounds = 4;  // a hole behind a hole shows only when the first is closed

/// The model's triangles and what is added to them.
class Patchwork {
 public:
  explicit Patchwork(const SurfaceModel& model)
      : points_(model.points()), triangles_(model.triangles()), names_(model.patchNames()) {
    for (Id t = 0; t < model.triangleCount(); ++t) patches_.push_back(model.patchOf(t));
  }
  void add(const std::vector<Vec3>& points, const std::vector<std::array<Id, 3>>& triangles) {
    if (triangles.empty()) return;
    const auto found = std::find(names_.begin(), names_.end(), kClosedHolesPatch);
    const Id patch = static_cast<Id>(found - names_.begin());
    if (found == names_.end()) names_.push_back(kClosedHolesPatch);
    const Id first = static_cast<Id>(points_.size());
    points_.insert(points_.end(), points.begin(), points.end());
    for (const auto& t : triangles) triangles_.push_back({t[0] + first, t[1] + first, t[2] + first});
    patches_.insert(patches_.end(), triangles.size(), patch);
    added_ += static_cast<Id>(triangles.size());
  }
  std::unique_ptr<SurfaceModel> model() const {
    return std::make_unique<SurfaceModel>(points_, triangles_, patches_, names_);
  }
  Id added() const { return added_; }

 private:
  std::vector<Vec3> points_;
  std::vector<SurfaceModel::Triangle> triangles_;
  std::vector<Id> patches_;
  std::vector<std::string> names_;
  Id added_ = 0;
};

bool wanted(const Leak& leak, const CloseHolesOptions& o) {
  return !leak.wide && (o.maximumWidth == 0 || leak.width <= o.maximumWidth);
}

std::vector<Vec3> placesOf(const std::vector<Pocket>& pockets, const Octree& tree) {
  std::vector<Vec3> places;
  for (const Pocket& p : pockets) places.push_back(tree.box(p.peak).centre());
  return places;
}

/// Of the leaves inside; endless where they reach the octree's own sides, behind which a room may go on.
Box boxOf(const Octree& tree, const std::vector<Side>& sides) {
  Box box;
  Coord end;
  for (int a = 0; a < 3; ++a) end[a] = tree.brick.extent(a);
  const Box whole{tree.brick.position({0, 0, 0}), tree.brick.position(end)};
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (sides[leaf] != Side::Inside) continue;
    box.add(tree.box(leaf).lo);
    box.add(tree.box(leaf).hi);
  }
  constexpr double endless = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    if (box.lo[a] <= whole.lo[a]) box.lo[a] = -endless;
    if (box.hi[a] >= whole.hi[a]) box.hi[a] = endless;
  }
  return box;
}

/// Search and closing of one round; holes found now are appended to the report.
class Closer {
 public:
  Closer(const SurfaceModel& model, const OctreeDecomposeOptions& octree, const CloseHolesOptions& options,
         Monitor& monitor, CloseHolesReport& report)
      : model_(model), octree_(octree), options_(options), monitor_(monitor), report_(report), work_(model) {}

  std::unique_ptr<SurfaceModel> run() {
    current_ = work_.model();
    LeakOptions search = options_.search;
    search.maximumLeaks = 0;
    search.roots = rootCellsOf(octree_);
    search.wideOpenings = options_.method == HoleMethod::ShowOnly;
    for (int round = 0; round < kRounds; ++round) {
      const Octree tree = decompose(*current_, octree_, monitor_);
      LeakSearch found = findLeaks(tree, *current_, search, monitor_);
      if (round == 0) {
        report_.pockets = found.pockets;
        // What was found once is looked for again by its place: a closed room is no room behind a narrow
        // opening.
        if (search.insidePoints.empty()) search.insidePoints = placesOf(found.pockets, tree);
      }
      const bool left = remember(found.leaks);
      report_.tight = !left;
      if (!left || options_.method == HoleMethod::ShowOnly) break;
      close(tree, found.sides, round, search);
    }
    report_.addedTriangles = work_.added();
    finish();
    return std::move(current_);
  }

 private:
  /// True when there is a leak that should be closed.
  bool remember(std::vector<Leak>& leaks) {
    fresh_.clear();
    for (Leak& leak : leaks) {
      const bool close = wanted(leak, options_);
      const bool known = std::any_of(report_.holes.begin(), report_.holes.end(), [&](const Hole& h) {
        return !h.closed && (h.leak.bottleneck - leak.bottleneck).norm() < 0.5 * leak.width;
      });
      if (!close && known) continue;
      if (close) fresh_.push_back(report_.holes.size());
      report_.holes.push_back({std::move(leak), false});
    }
    return !fresh_.empty();
  }

  void close(const Octree& tree, const std::vector<Side>& sides, int round, const LeakOptions& search) {
    // A cap that does not seal is not made better by another one: later rounds use membranes.
    if (options_.method == HoleMethod::Offset && round == 0) {
      addCaps(tree, sides, search);
    } else {
      for (std::size_t h : fresh_) {
        const Membrane& m = report_.holes[h].leak.membrane;
        work_.add(m.points, m.triangles);
      }
    }
    for (std::size_t h : fresh_) report_.holes[h].closed = true;
    current_ = work_.model();
  }

  void addCaps(const Octree& tree, const std::vector<Side>& sides, const LeakOptions& search) {
    const double cell = tree.brick.edge(tree.brick.maxLevel);
    OffsetOptions o;
    std::vector<const Leak*> holes;
    for (std::size_t h : fresh_) {
      holes.push_back(&report_.holes[h].leak);
      o.coarseSize =
          std::max(o.coarseSize, sealingSize(holes.back()->width, tree.brick, RootCells::FromFeature));
    }
    o.offset = 0.1 * cell;
    o.seals = [&](const Caps& caps) { return seals(caps, search); };
    o.overlap = 2 * cell;
    o.finest = cell;
    o.rooms = boxOf(tree, sides);
    const auto inside = [&](const Vec3& p) {
      const Id leaf = tree.locate(p);
      return leaf != kNone && sides[leaf] == Side::Inside;
    };
    const Caps caps = offsetCaps(model_, octree_, o, inside, holes, monitor_);
    report_.coarseSize = caps.coarseSize;
    work_.add(caps.points, caps.triangles);
  }

  bool seals(const Caps& caps, const LeakOptions& search) {
    Patchwork trial = work_;
    trial.add(caps.points, caps.triangles);
    const auto model = trial.model();
    const LeakSearch found = findLeaks(decompose(*model, octree_, monitor_), *model, search, monitor_);
    return std::none_of(found.leaks.begin(), found.leaks.end(),
                        [&](const Leak& leak) { return wanted(leak, options_); });
  }

  void finish() {
    std::stable_sort(report_.holes.begin(), report_.holes.end(),
                     [](const Hole& a, const Hole& b) { return a.leak.width > b.leak.width; });
    if (options_.method != HoleMethod::ShowOnly && !report_.tight)
      monitor_.warning(
          fmt::format("{} leak(s) are left after {} rounds of closing; use a larger feature size.",
                      fresh_.size(), kRounds));
  }

  const SurfaceModel& model_;
  const OctreeDecomposeOptions& octree_;
  const CloseHolesOptions& options_;
  Monitor& monitor_;
  CloseHolesReport& report_;
  Patchwork work_;
  std::unique_ptr<SurfaceModel> current_;
  std::vector<std::size_t> fresh_;  // rows of report_.holes to close now
};

}  // namespace

RootCells rootCellsOf(const OctreeDecomposeOptions& octree) {
  return octree.baseSize > 0 || octree.useDomain || octree.maxLevel >= 0 ? RootCells::Unknown
                                                                         : RootCells::FromFeature;
}

std::unique_ptr<SurfaceModel> closeHoles(const SurfaceModel& model, const OctreeDecomposeOptions& octree,
                                         const CloseHolesOptions& options, Monitor& monitor,
                                         CloseHolesReport* report) {
  CloseHolesReport local;
  CloseHolesReport& r = report ? *report : local;
  r = {};
  return Closer(model, octree, options, monitor, r).run();
}

}  // namespace pm
