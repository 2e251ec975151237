// SPDX-License-Identifier: BSD-3-Clause
#include "ThinPlaces.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "DisjointSets.h"

namespace pm {
namespace {

constexpr double kClear = 0.57736;  // 1 / sqrt(3), of a leaf's edge

class ThinPlaces {
 public:
  ThinPlaces(const Octree& tree, const SurfaceModel& model, std::vector<Id>& setOf)
      : tree_(tree), model_(model), setOf_(setOf), joined_(0) {}

  void run() {
    const Id sets = setOf_.empty() ? 0 : *std::max_element(setOf_.begin(), setOf_.end()) + 1;
    joined_ = DisjointSets(sets);
    findRooms(sets);
    const std::vector<Id> candidates = findCandidates();
    if (candidates.empty()) return;
    for (bool any = true; any;) {  // a link may give another one its second neighbour
      any = false;
      for (Id leaf : candidates) any = (setOf_[leaf] == kNone && link(leaf)) || any;
    }
    renumber(sets);
  }

 private:
  template <class Body>
  void forNeighbours(Id leaf, const Body& body) const {
    std::array<Id, 4> n;
    for (int side = 0; side < 6; ++side)
      for (int k = tree_.faceNeighbours(leaf, side, n); k-- > 0;) body(n[k]);
  }

  bool atSide(Id leaf) const {
    std::array<Id, 4> n;
    for (int side = 0; side < 6; ++side)
      if (tree_.faceNeighbours(leaf, side, n) == 0) return true;
    return false;
  }

  void findRooms(Id sets) {
    isRoom_.assign(sets, 0);
    for (Id leaf = 0; leaf < tree_.size(); ++leaf) {
      if (setOf_[leaf] == kNone || isRoom_[setOf_[leaf]]) continue;
      bool inner = true;
      forNeighbours(leaf, [&](Id n) { inner = inner && setOf_[n] != kNone; });
      isRoom_[setOf_[leaf]] = inner || atSide(leaf);
    }
  }

  /// Cut leaves beside a set that is no room, whose centres are far enough inside; ascending.
  std::vector<Id> findCandidates() const {
    std::vector<Id> beside;
    for (Id leaf = 0; leaf < tree_.size(); ++leaf)
      if (setOf_[leaf] != kNone && !isRoom_[setOf_[leaf]])
        forNeighbours(leaf, [&](Id n) {
          if (setOf_[n] == kNone) beside.push_back(n);
        });
    sortUnique(beside);
    std::vector<std::uint8_t> fits(beside.size());
    tbb::parallel_for(std::size_t(0), beside.size(),
                      [&](std::size_t i) { fits[i] = isClear(tree_.box(beside[i]).centre(), beside[i]); });
    std::vector<Id> candidates;
    for (std::size_t i = 0; i < beside.size(); ++i)
      if (fits[i]) candidates.push_back(beside[i]);
    return candidates;
  }

  bool isClear(const Vec3& p, Id leaf) const {
    const double least = kClear * tree_.brick.edge(tree_.levels[leaf]);
    return model_.closest(p, {}, least).distance2 >= least * least;
  }

  Vec3 middleOfFace(Id leaf, Id neighbour) const {
    const Box a = tree_.box(leaf), b = tree_.box(neighbour);
    return 0.5 * (a.lo.cwiseMax(b.lo) + a.hi.cwiseMin(b.hi));
  }

  /// Joins the sets beside the leaf where it links several. It does so, too, where others have joined them
  /// already: one link alone would leave a slit beside it.
  bool link(Id leaf) {
    const Vec3 centre = tree_.box(leaf).centre();
    std::vector<Id> sets, roots;
    bool sees = true;
    forNeighbours(leaf, [&](Id n) {
      if (setOf_[n] == kNone) return;
      roots.push_back(joined_.root(setOf_[n]));
      sees = sees && !model_.crosses(centre, tree_.box(n).centre());
      if (isClear(middleOfFace(leaf, n), leaf)) sets.push_back(setOf_[n]);
    });
    sortUnique(sets);
    sortUnique(roots);
    const auto rooms = std::count_if(roots.begin(), roots.end(), [&](Id r) { return isRoom_[r] != 0; });
    if (sets.size() < 2 || rooms > 1 || !sees) return false;
    for (Id r : roots) joined_.join(roots[0], r);
    isRoom_[joined_.root(roots[0])] = rooms == 1;
    setOf_[leaf] = roots[0];
    return true;
  }

  void renumber(Id sets) {
    std::vector<Id> number(sets, kNone);
    Id count = 0;
    for (Id& set : setOf_) {
      if (set == kNone) continue;
      Id& n = number[joined_.root(set)];
      if (n == kNone) n = count++;
      set = n;
    }
  }

  const Octree& tree_;
  const SurfaceModel& model_;
  std::vector<Id>& setOf_;
  DisjointSets joined_;
  std::vector<std::uint8_t> isRoom_;  // by root
};

}  // namespace

void joinThinPlaces(const Octree& tree, const SurfaceModel& model, std::vector<Id>& setOf) {
  ThinPlaces(tree, model, setOf).run();
}

}  // namespace pm
