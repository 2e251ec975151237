// SPDX-License-Identifier: BSD-3-Clause
#include "SelfIntersections.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "Bvh.h"

namespace pm {

namespace {

using Triangle = SurfaceModel::Triangle;

constexpr Id kBlock = 256;        // slots of one task
constexpr Id kBlocksAtOnce = 64;  // between two looks at the monitor

/// A pair that meets, with the names of the ends of its segment.
struct Meeting {
  Id a, b;
  TriangleContact contact;
};

bool byTriangles(const Meeting& x, const Meeting& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }

/// Pairs of boxes that overlap, each once: pair(i, j) with the items' numbers. Blocks can run beside each
/// other. skip(node, begin, end): need no item below the node be paired with one of these slots?
class OverlapSearch {
 public:
  OverlapSearch(const Bvh& bvh, const std::vector<Box>& boxes) : bvh_(bvh), bySlot_(boxes.size()) {
    tbb::parallel_for(std::size_t(0), boxes.size(),
                      [&](std::size_t slot) { bySlot_[slot] = boxes[bvh.order()[slot]]; });
  }

  Id blocks() const { return (size() + kBlock - 1) / kBlock; }

  template <class Skip, class Pair>
  void run(Id block, const Skip& skip, const Pair& pair) const {
    const Id last = std::min(size(), (block + 1) * kBlock);
    for (Id slot = block * kBlock; slot < last; slot += Bvh::kLeafSize)
      searchLeaf(slot, std::min(last, slot + Bvh::kLeafSize), skip, pair);
  }

 private:
  Id size() const { return static_cast<Id>(bySlot_.size()); }

  /// Each pair once: at the smaller slot.
  template <class Skip, class Pair>
  void searchLeaf(Id begin, Id end, const Skip& skip, const Pair& pair) const {
    Box leaf;
    for (Id slot = begin; slot < end; ++slot) {
      leaf.add(bySlot_[slot].lo);
      leaf.add(bySlot_[slot].hi);
    }
    const auto enter = [&](Id node, const Box& box) { return box.overlaps(leaf) && !skip(node, begin, end); };
    bvh_.any(enter, [&](Id other) {
      for (Id slot = begin; slot < std::min(end, other); ++slot)
        if (bySlot_[slot].overlaps(bySlot_[other])) pair(bvh_.order()[slot], bvh_.order()[other]);
      return false;
    });
  }

  const Bvh& bvh_;
  std::vector<Box> bySlot_;
};

/// Points that very many triangles share: their boxes all overlap there, so such pairs are found by the
/// directions in which the triangles leave the point.
class Hubs {
 public:
  explicit Hubs(const SurfaceModel& model) : model_(model), ofTriangle_(model.triangleCount(), kNone) {
    std::vector<Id> uses(model.points().size(), 0);
    for (const Triangle& t : model.triangles())
      for (Id p : t) ++uses[p];
    for (Id t = 0; t < model.triangleCount(); ++t) {
      const Triangle& ids = model.triangles()[t];
      const Id p = *std::max_element(ids.begin(), ids.end(), [&](Id x, Id y) { return uses[x] < uses[y]; });
      if (uses[p] >= kLeastUses) ofTriangle_[t] = p;
    }
    for (Id t = 0; t < model.triangleCount(); ++t)
      if (ofTriangle_[t] != kNone) sorted_.push_back(t);
    std::stable_sort(sorted_.begin(), sorted_.end(),
                     [&](Id x, Id y) { return ofTriangle_[x] < ofTriangle_[y]; });
  }

  /// The point at which the triangle's pairs are found by direction, or kNone.
  Id of(Id triangle) const { return ofTriangle_[triangle]; }

  /// Calls body with the triangles of each hub.
  template <class Body>
  void forEach(const Body& body) const {
    for (auto first = sorted_.begin(); first != sorted_.end();) {
      const auto last = std::find_if(first, sorted_.end(), [&](Id t) { return of(t) != of(*first); });
      body(std::vector<Id>(first, last));
      first = last;
    }
  }

  /// Holds all directions from the hub into the triangle.
  Box directions(Id triangle) const {
    const Triangle& ids = model_.triangles()[triangle];
    const Id hub = of(triangle);
    std::array<Vec3, 2> ends;
    int count = 0;
    for (Id p : ids)
      if (p != hub) ends[count++] = (model_.points()[p] - model_.points()[hub]).stableNormalized();
    Box box;
    for (const Vec3& end : ends) box.add(end);
    // The arc between the ends is nowhere farther from its chord than where it is half-way.
    const double halfChord2 = std::min(1.0, (ends[1] - ends[0]).squaredNorm() / 4);
    const double bulge = halfChord2 / (1 + std::sqrt(1 - halfChord2)) + kRounding;
    box.lo.array() -= bulge;
    box.hi.array() += bulge;
    return box;
  }

 private:
  static constexpr Id kLeastUses = 48;
  static constexpr double kRounding = 1e-12;

  const SurfaceModel& model_;
  std::vector<Id> ofTriangle_;
  std::vector<Id> sorted_;  // triangles with a hub, by hub
};

class Search {
 public:
  explicit Search(const SurfaceModel& model) : model_(model), hubs_(model) {}

  std::vector<Meeting> run(Monitor& monitor) {
    searchBoxes(monitor);
    hubs_.forEach([&](const std::vector<Id>& triangles) { searchHub(triangles, monitor); });
    tbb::parallel_sort(found_.begin(), found_.end(), byTriangles);
    return std::move(found_);
  }

 private:
  /// All pairs but those at a common hub.
  void searchBoxes(Monitor& monitor) {
    std::vector<Box> boxes(model_.triangleCount());
    tbb::parallel_for(Id(0), model_.triangleCount(), [&](Id t) {
      for (int k = 0; k < 3; ++k) boxes[t].add(model_.corner(t, k));
    });
    const Bvh& bvh = model_.hierarchy();
    constexpr Id kMixed = kNone;
    const std::vector<Id> hubOfNode =
        bvh.childValues<Id>([&](Id slot) { return hubs_.of(bvh.order()[slot]); },
                            [&](Id& hub, Id other) {
                              if (other != hub) hub = kMixed;
                            });
    const auto skip = [&](Id node, Id begin, Id end) {
      if (hubOfNode[node] == kMixed) return false;
      for (Id slot = begin; slot < end; ++slot)
        if (hubs_.of(bvh.order()[slot]) != hubOfNode[node]) return false;
      return true;
    };
    const auto isOfHub = [&](Id a, Id b) { return hubs_.of(a) != kNone && hubs_.of(a) == hubs_.of(b); };
    collect(OverlapSearch(bvh, boxes), monitor, skip, [&](Id a, Id b, std::vector<Meeting>& found) {
      if (!isOfHub(a, b)) test(a, b, found);
    });
  }

  /// Triangles around one point that meet elsewhere too leave it in a common direction.
  void searchHub(const std::vector<Id>& triangles, Monitor& monitor) {
    std::vector<Box> boxes(triangles.size());
    tbb::parallel_for(std::size_t(0), triangles.size(),
                      [&](std::size_t i) { boxes[i] = hubs_.directions(triangles[i]); });
    const Bvh bvh(boxes);
    const auto none = [](Id, Id, Id) { return false; };
    collect(OverlapSearch(bvh, boxes), monitor, none,
            [&](Id i, Id j, std::vector<Meeting>& found) { test(triangles[i], triangles[j], found); });
  }

  template <class Skip, class Pair>
  void collect(const OverlapSearch& search, Monitor& monitor, const Skip& skip, const Pair& pair) {
    std::vector<std::vector<Meeting>> found(search.blocks());
    for (Id first = 0; first < search.blocks(); first += kBlocksAtOnce) {
      monitor.check(double(first) / search.blocks(), "self-intersections");
      const Id last = std::min(search.blocks(), first + kBlocksAtOnce);
      tbb::parallel_for(first, last, [&](Id block) {
        search.run(block, skip, [&](Id a, Id b) { pair(a, b, found[block]); });
      });
    }
    for (const auto& part : found) found_.insert(found_.end(), part.begin(), part.end());
  }

  void test(Id t, Id u, std::vector<Meeting>& found) const {
    const auto [a, b] = std::minmax(t, u);
    const TriangleContact contact = contactOf(model_.points(), model_.triangles()[a], model_.triangles()[b]);
    if (contact.kind != Contact::None) found.push_back({a, b, contact});
  }

  const SurfaceModel& model_;
  const Hubs hubs_;
  std::vector<Meeting> found_;
};

bool isSegment(const Meeting& m) { return m.contact.count == 2; }

}  // namespace

SelfIntersections selfIntersections(const SurfaceModel& model, Monitor& monitor) {
  const std::vector<Meeting> meetings = Search(model).run(monitor);
  SelfIntersections out;
  for (const Meeting& m : meetings) {
    out.pairs.push_back({m.a, m.b, m.contact.kind});
    if (isSegment(m)) out.names.insert(out.names.end(), m.contact.ends.begin(), m.contact.ends.end());
  }
  tbb::parallel_sort(out.names.begin(), out.names.end());
  out.names.erase(std::unique(out.names.begin(), out.names.end()), out.names.end());
  out.points.resize(out.names.size());
  tbb::parallel_for(std::size_t(0), out.names.size(),
                    [&](std::size_t i) { out.points[i] = positionOf(model.points(), out.names[i]); });
  const auto row = [&](const MeetingPoint& name) {
    return static_cast<Id>(std::lower_bound(out.names.begin(), out.names.end(), name) - out.names.begin());
  };
  for (const Meeting& m : meetings) {
    if (!isSegment(m)) continue;
    const auto [start, end] = std::minmax({row(m.contact.ends[0]), row(m.contact.ends[1])});
    out.segments.push_back({m.a, m.b, start, end, m.contact.kind});
  }
  return out;
}

}  // namespace pm
