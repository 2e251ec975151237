// SPDX-License-Identifier: BSD-3-Clause
#include "OctreeBuilder.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "TriangleBox.h"

namespace pm {
namespace {

constexpr std::uint32_t kRun = 2048;       // triangles of one cell that are tested together
constexpr Id kTrianglesPerBlock = 4096;    // triangles that are put into root cells together
constexpr std::size_t kEnoughParts = 256;  // subtrees to share among threads in finish()

struct RootHit {
  Id root, triangle;
};

/// First and last root cell along an axis that the interval [lo, hi] may touch.
std::array<Id, 2> rootRange(const Brick& brick, int axis, double lo, double hi) {
  const auto cell = [&](double x) {
    const double place = (x - brick.origin[axis]) / brick.rootSize[axis];
    return static_cast<Id>(std::floor(std::clamp(place, -1.0, double(brick.roots[axis]))));
  };
  // One cell more on either side, for rounding; the test of the cell itself decides.
  const Id last = brick.roots[axis] - 1;
  const double slack = 1e-6 * brick.rootSize[axis];
  return {std::clamp(cell(lo - slack), Id(0), last), std::clamp(cell(hi + slack), Id(0), last)};
}

void checkListSize(std::size_t entries) {
  if (entries > std::size_t(std::numeric_limits<Id>::max()))
    throw BudgetError(
        "The octree would hold more than 2 billion triangle references; use a larger feature size.");
}

}  // namespace

OctreeBuilder::OctreeBuilder(const Brick& brick, const SurfaceModel& model) : model_(model), brick_(brick) {
  for (int level = 0; level <= brick.maxLevel; ++level) slack_.push_back(touchSlack(brick, level));
  makeRoots();
  listRoots();
}

void OctreeBuilder::makeRoots() {
  const auto& r = brick_.roots;
  const int shift = brick_.maxLevel;
  nodes_.grow(std::size_t(r[0]) * r[1] * r[2]);
  Id i = 0;
  for (std::int32_t z = 0; z < r[2]; ++z)
    for (std::int32_t y = 0; y < r[1]; ++y)
      for (std::int32_t x = 0; x < r[0]; ++x) nodes_[i++].key = encode({x << shift, y << shift, z << shift});
  leafCount_ = size();
}

// The uniform grid: each triangle goes to the root cells that its box overlaps and itself touches.
void OctreeBuilder::listRoots() {
  const Id count = model_.triangleCount();
  const double slack = slack_[0];
  std::vector<std::vector<RootHit>> hits((count + kTrianglesPerBlock - 1) / kTrianglesPerBlock);
  tbb::parallel_for(std::size_t(0), hits.size(), [&](std::size_t block) {
    const Id first = static_cast<Id>(block) * kTrianglesPerBlock;
    for (Id t = first; t < std::min(count, first + kTrianglesPerBlock); ++t) {
      const Vec3 &a = model_.corner(t, 0), &b = model_.corner(t, 1), &c = model_.corner(t, 2);
      const Vec3 lo = a.cwiseMin(b).cwiseMin(c), hi = a.cwiseMax(b).cwiseMax(c);
      std::array<Id, 2> range[3];
      for (int axis = 0; axis < 3; ++axis) range[axis] = rootRange(brick_, axis, lo[axis], hi[axis]);
      for (Id z = range[2][0]; z <= range[2][1]; ++z)
        for (Id y = range[1][0]; y <= range[1][1]; ++y)
          for (Id x = range[0][0]; x <= range[0][1]; ++x) {
            const Id root = x + brick_.roots[0] * (y + brick_.roots[1] * z);
            if (touches(box(nodes_[root]), a, b, c, slack)) hits[block].push_back({root, t});
          }
    }
  });
  for (const auto& block : hits)
    for (const RootHit& hit : block) ++nodes_[hit.root].triangles;
  std::vector<std::uint32_t> next(nodes_.size());
  std::size_t end = 0;
  for (Id i = 0; i < size(); ++i) {
    nodes_[i].firstTriangle = next[i] = static_cast<std::uint32_t>(end);
    end += nodes_[i].triangles;
  }
  checkListSize(end);
  pool_.resize(end);
  for (const auto& block : hits)
    for (const RootHit& hit : block) pool_[next[hit.root]++] = hit.triangle;
}

Id OctreeBuilder::find(const Coord& c, int level) const {
  if (!brick_.inside(c)) return kNone;
  const int shift = brick_.maxLevel;
  Id i = (c[0] >> shift) + brick_.roots[0] * ((c[1] >> shift) + brick_.roots[1] * (c[2] >> shift));
  for (int l = 1; l <= level && !nodes_[i].isLeaf(); ++l) {
    const int bit = shift - l;
    i = nodes_[i].firstChild + (((c[0] >> bit) & 1) | ((c[1] >> bit) & 1) << 1 | ((c[2] >> bit) & 1) << 2);
  }
  return i;
}

Id OctreeBuilder::neighbour(const Node& n, const Coord& d) const {
  Coord c = decode(n.key);
  const std::int32_t span = brick_.span(n.level);
  for (int a = 0; a < 3; ++a) c[a] += d[a] * span;
  return find(c, n.level);
}

void OctreeBuilder::split(const std::vector<Id>& leaves) {
  dropOldLists();
  const std::size_t firstNew = nodes_.size();
  nodes_.grow(firstNew + 8 * leaves.size());
  leafCount_ += 7 * static_cast<std::int64_t>(leaves.size());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    Node& parent = nodes_[leaves[i]];
    parent.firstChild = static_cast<Id>(firstNew + 8 * i);
    for (int k = 0; k < 8; ++k) {
      Node& child = nodes_[parent.firstChild + k];
      child.level = parent.level + 1;
      child.reason = RefineReason::Balance;
      child.key = parent.key + (Key(k) << (3 * (brick_.maxLevel - child.level)));
    }
  });
  std::vector<Run> runs = runsOf(leaves);
  std::vector<std::uint8_t> touched(runs.empty() ? 0 : runs.back().firstByte + runs.back().count);
  tbb::parallel_for(std::size_t(0), runs.size(),
                    [&](std::size_t i) { testChildren(runs[i], touched.data() + runs[i].firstByte); });
  makeRoom(runs, static_cast<Id>(firstNew));
  tbb::parallel_for(std::size_t(0), runs.size(),
                    [&](std::size_t i) { fillChildren(runs[i], touched.data() + runs[i].firstByte); });
}

void OctreeBuilder::explain(Id parent, const RefineCause& cause) {
  for (Id child = nodes_[parent].firstChild; child < nodes_[parent].firstChild + 8; ++child) {
    nodes_[child].reason = cause.reason;
    nodes_[child].patch = cause.patch;
  }
}

std::vector<OctreeBuilder::Run> OctreeBuilder::runsOf(const std::vector<Id>& leaves) const {
  std::vector<Run> runs;
  std::size_t bytes = 0;
  for (Id leaf : leaves) {
    const Node& n = nodes_[leaf];
    for (std::uint32_t done = 0; done < n.triangles; done += kRun) {
      const std::uint32_t count = std::min(kRun, n.triangles - done);
      runs.push_back({leaf, n.firstTriangle + done, count, bytes, {}});
      bytes += count;
    }
  }
  return runs;
}

void OctreeBuilder::testChildren(Run& run, std::uint8_t* touched) const {
  const Node& parent = nodes_[run.leaf];
  const double slack = slack_[parent.level];
  const std::int32_t half = brick_.span(parent.level) / 2;
  const Coord lo = decode(parent.key);
  const Coord middle{lo[0] + half, lo[1] + half, lo[2] + half};
  const Coord hi{middle[0] + half, middle[1] + half, middle[2] + half};
  const ChildPlanes planes{brick_.position(lo), brick_.position(middle), brick_.position(hi)};
  for (std::uint32_t j = 0; j < run.count; ++j) {
    const Id t = pool_[run.first + j];
    touched[j] =
        touchedChildren(planes, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2), slack);
    for (int k = 0; k < 8; ++k) run.inChild[k] += touched[j] >> k & 1;
  }
}

// Runs of a leaf follow each other, and so do their entries in the lists of its children; counts become
// places.
void OctreeBuilder::makeRoom(std::vector<Run>& runs, Id firstNew) {
  for (const Run& run : runs) {
    poolGarbage_ += run.count;
    for (int k = 0; k < 8; ++k) nodes_[nodes_[run.leaf].firstChild + k].triangles += run.inChild[k];
  }
  std::size_t end = pool_.size();
  for (Id n = firstNew; n < size(); ++n) {
    nodes_[n].firstTriangle = static_cast<std::uint32_t>(end);
    end += nodes_[n].triangles;
  }
  checkListSize(end);
  pool_.resize(end);
  std::array<std::uint32_t, 8> next{};
  Id leaf = kNone;
  for (Run& run : runs)
    for (int k = 0; k < 8; ++k) {
      if (run.leaf != leaf) next[k] = nodes_[nodes_[run.leaf].firstChild + k].firstTriangle;
      next[k] += run.inChild[k];
      run.inChild[k] = next[k] - run.inChild[k];
      if (k == 7) leaf = run.leaf;
    }
}

void OctreeBuilder::fillChildren(const Run& run, const std::uint8_t* touched) {
  std::array<std::uint32_t, 8> next = run.inChild;
  for (std::uint32_t j = 0; j < run.count; ++j)
    for (unsigned bits = touched[j]; bits != 0; bits &= bits - 1) {
      int k = 0;
      while (!(bits >> k & 1)) ++k;
      pool_[next[k]++] = pool_[run.first + j];
    }
}

// Once most of the pool belongs to split nodes, the lists of leaves move together.
void OctreeBuilder::dropOldLists() {
  if (2 * poolGarbage_ <= pool_.size()) return;
  std::vector<Id> kept;
  kept.reserve(pool_.size() - poolGarbage_);
  for (Id i = 0; i < size(); ++i) {
    Node& n = nodes_[i];
    if (!n.isLeaf() || !n.isCut()) continue;
    const Span<Id> list = triangles(n);
    n.firstTriangle = static_cast<std::uint32_t>(kept.size());
    kept.insert(kept.end(), list.begin(), list.end());
  }
  pool_.swap(kept);
  poolGarbage_ = 0;
}

std::vector<OctreeBuilder::Family> OctreeBuilder::familiesOf(const std::vector<Id>& ascending) const {
  const Id roots = brick_.roots[0] * brick_.roots[1] * brick_.roots[2];
  std::vector<Family> families;
  for (Id i : ascending) {
    if (i < roots) continue;
    const Id place = (i - roots) % 8, first = i - place;
    if (families.empty() || families.back().first != first) families.push_back({first, 0});
    families.back().members |= std::uint8_t(1) << place;
  }
  return families;
}

// Cells of the members' level exist where their parents are split, so the parents within reach are looked at,
// once for all members that reach them.
void OctreeBuilder::lookAround(const Family& family, int cells, Grading& found) const {
  constexpr std::uint8_t kUpper[3] = {0xaa, 0xcc, 0xf0};  // children in the upper half along each axis
  const Node& first = nodes_[family.first];
  const int parentLevel = first.level - 1;
  const std::int32_t span = brick_.span(parentLevel);
  const Coord c = decode(first.key);
  const auto reaching = [&](int axis, int d) {
    const bool lower = d >= -cells >> 1 && d <= cells >> 1,
               upper = d >= (1 - cells) >> 1 && d <= (1 + cells) >> 1;
    return std::uint8_t((lower ? ~kUpper[axis] : 0) | (upper ? kUpper[axis] : 0));
  };
  std::uint8_t unsettled = 0;
  const int lo = -cells >> 1, hi = (1 + cells) >> 1;
  for (int z = lo; z <= hi; ++z)
    for (int y = lo; y <= hi; ++y)
      for (int x = lo; x <= hi; ++x) {
        const std::uint8_t members = family.members & reaching(0, x) & reaching(1, y) & reaching(2, z);
        if (members == 0 || (x == 0 && y == 0 && z == 0)) continue;
        const Id parent = find({c[0] + x * span, c[1] + y * span, c[2] + z * span}, parentLevel);
        if (parent == kNone || !nodes_[parent].isLeaf()) continue;
        found.leaves.push_back(parent);
        if (nodes_[parent].level < parentLevel) unsettled |= members;
      }
  for (Id k = 0; k < 8; ++k)
    if (unsettled >> k & 1) found.unsettled.push_back(family.first + k);
}

OctreeBuilder::Grading OctreeBuilder::tooCoarse(const std::vector<Id>& changed, int cells) const {
  const std::vector<Family> families = familiesOf(changed);
  tbb::enumerable_thread_specific<Grading> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, families.size(), 64), [&](const auto& range) {
    Grading& mine = found.local();
    for (std::size_t i = range.begin(); i < range.end(); ++i) lookAround(families[i], cells, mine);
  });
  Grading all;
  for (const Grading& mine : found) {
    all.leaves.insert(all.leaves.end(), mine.leaves.begin(), mine.leaves.end());
    all.unsettled.insert(all.unsettled.end(), mine.unsettled.begin(), mine.unsettled.end());
  }
  for (auto* list : {&all.leaves, &all.unsettled}) {
    tbb::parallel_sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  return all;
}

void OctreeBuilder::balance(int cells) {
  std::vector<Id> changed;
  for (Id i = 0; i < size(); ++i)
    if (!nodes_[i].isLeaf()) changed.push_back(i);
  for (;;) {
    const Grading grading = tooCoarse(changed, cells);
    if (grading.leaves.empty()) return;
    split(grading.leaves);
    changed = grading.unsettled;
    changed.insert(changed.end(), grading.leaves.begin(), grading.leaves.end());
    tbb::parallel_sort(changed.begin(), changed.end());
  }
}

template <class Body>
void OctreeBuilder::forLeavesBelow(Id i, const Body& body) const {
  const Node& n = nodes_[i];
  if (n.isLeaf()) return body(n);
  for (int k = 0; k < 8; ++k) forLeavesBelow(n.firstChild + k, body);
}

// Children follow each other in Morton order, so only the root cells need sorting.
std::vector<OctreeBuilder::Part> OctreeBuilder::partsInOrder() const {
  std::vector<Part> parts;
  for (Id i = 0; i < brick_.roots[0] * brick_.roots[1] * brick_.roots[2]; ++i) parts.push_back({i});
  std::sort(parts.begin(), parts.end(),
            [&](const Part& a, const Part& b) { return nodes_[a.node].key < nodes_[b.node].key; });
  for (int level = 0; level < brick_.maxLevel && parts.size() < kEnoughParts; ++level) {
    std::vector<Part> finer;
    for (const Part& part : parts)
      if (const Node& n = nodes_[part.node]; n.isLeaf())
        finer.push_back(part);
      else
        for (int k = 0; k < 8; ++k) finer.push_back({n.firstChild + k});
    parts.swap(finer);
  }
  return parts;
}

Octree OctreeBuilder::collect() const {
  std::vector<Part> parts = partsInOrder();
  tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
    forLeavesBelow(parts[i].node, [&](const Node& leaf) {
      ++parts[i].leaves;
      parts[i].triangles += leaf.triangles;
    });
  });
  for (std::size_t i = 1; i < parts.size(); ++i) {
    parts[i].firstLeaf = parts[i - 1].firstLeaf + parts[i - 1].leaves;
    parts[i].firstTriangle = parts[i - 1].firstTriangle + parts[i - 1].triangles;
  }
  Octree tree;
  tree.brick = brick_;
  tree.keys.resize(leafCount_);
  tree.levels.resize(leafCount_);
  tree.cut.resize(leafCount_);
  tree.refinedBy.resize(leafCount_);
  tree.refinedByPatch.resize(leafCount_);
  tree.triangles.offsets.resize(leafCount_ + 1);
  tree.triangles.values.resize(parts.back().firstTriangle + parts.back().triangles);
  tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
    Id at = parts[i].firstLeaf, end = static_cast<Id>(parts[i].firstTriangle);
    forLeavesBelow(parts[i].node, [&](const Node& leaf) {
      tree.keys[at] = leaf.key;
      tree.levels[at] = leaf.level;
      tree.cut[at] = leaf.isCut();
      tree.refinedBy[at] = static_cast<std::uint8_t>(leaf.reason);
      tree.refinedByPatch[at] = leaf.patch;
      const Span<Id> list = triangles(leaf);
      std::copy(list.begin(), list.end(), tree.triangles.values.begin() + end);
      end += static_cast<Id>(list.size());
      tree.triangles.offsets[++at] = end;
    });
  });
  return tree;
}

Octree OctreeBuilder::finish() const& {
  Octree tree = collect();
  tree.index();
  return tree;
}

Octree OctreeBuilder::finish() && {
  Octree tree = collect();
  nodes_.clear();
  pool_ = {};
  poolGarbage_ = 0;
  leafCount_ = 0;
  tree.index();
  return tree;
}

}  // namespace pm
