// SPDX-License-Identifier: BSD-3-Clause
#include "SelfIntersections.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "Bvh.h"

namespace pm {

namespace {

using Triangle = SurfaceModel::Triangle;

constexpr Id kBlock = 1024;       // slots of one task
constexpr Id kBlocksAtOnce = 64;  // between two looks at the monitor

/// A pair that meets, with the names of the ends of its segment.
struct Meeting {
  Id a, b;
  TriangleContact contact;
};

bool byTriangles(const Meeting& x, const Meeting& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }

class Search {
 public:
  explicit Search(const SurfaceModel& model) : model_(model) {
    std::vector<Box> boxes(model.triangleCount());
    tbb::parallel_for(Id(0), model.triangleCount(), [&](Id t) {
      for (int k = 0; k < 3; ++k) boxes[t].add(model.corner(t, k));
    });
    bvh_ = Bvh(boxes);
    boxes_.resize(boxes.size());
    tbb::parallel_for(Id(0), model.triangleCount(),
                      [&](Id slot) { boxes_[slot] = boxes[bvh_.order()[slot]]; });
  }

  std::vector<Meeting> run(Monitor& monitor) const {
    const Id blocks = (model_.triangleCount() + kBlock - 1) / kBlock;
    std::vector<std::vector<Meeting>> found(blocks);
    for (Id first = 0; first < blocks; first += kBlocksAtOnce) {
      monitor.check(double(first) / blocks, "self-intersections");
      const Id last = std::min(blocks, first + kBlocksAtOnce);
      tbb::parallel_for(first, last, [&](Id block) { searchBlock(block, found[block]); });
    }
    std::vector<Meeting> all;
    for (auto& part : found) {
      all.insert(all.end(), part.begin(), part.end());
      part = {};
    }
    tbb::parallel_sort(all.begin(), all.end(), byTriangles);
    return all;
  }

 private:
  void searchBlock(Id block, std::vector<Meeting>& found) const {
    const Id last = std::min(model_.triangleCount(), (block + 1) * kBlock);
    for (Id slot = block * kBlock; slot < last; slot += Bvh::kLeafSize)
      searchLeaf(slot, std::min(last, slot + Bvh::kLeafSize), found);
  }

  /// Each pair once: at the smaller slot.
  void searchLeaf(Id begin, Id end, std::vector<Meeting>& found) const {
    Box box;
    for (Id slot = begin; slot < end; ++slot) {
      box.add(boxes_[slot].lo);
      box.add(boxes_[slot].hi);
    }
    bvh_.overlapping(box, [&](Id other) {
      for (Id slot = begin; slot < std::min(end, other); ++slot)
        if (boxes_[slot].overlaps(boxes_[other])) test(slot, other, found);
    });
  }

  void test(Id slot, Id other, std::vector<Meeting>& found) const {
    const auto [a, b] = std::minmax(bvh_.order()[slot], bvh_.order()[other]);
    const TriangleContact contact = contactOf(model_.points(), model_.triangles()[a], model_.triangles()[b]);
    if (contact.kind != Contact::None) found.push_back({a, b, contact});
  }

  const SurfaceModel& model_;
  Bvh bvh_;
  std::vector<Box> boxes_;  // #T by slot
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
