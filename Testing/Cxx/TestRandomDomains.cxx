// SPDX-License-Identifier: BSD-3-Clause
#include "TestRandomDomains.h"

#include <algorithm>
#include <cmath>

#include "FrontMesh.h"
#include "FrontRepair.h"
#include "OctreeBuilder.h"

namespace pm::testing {

namespace {

using Generator = std::mt19937_64;

int pick(Generator& g, int lo, int hi) { return lo + static_cast<int>(g() % (hi - lo + 1)); }
double chance(Generator& g) { return static_cast<double>(g() >> 11) / 9007199254740992.0; }

Brick randomBrick(Generator& g, double stretch) {
  Brick brick;
  brick.maxLevel = pick(g, 0, 2);
  const int most = brick.maxLevel == 0 ? 6 : brick.maxLevel == 1 ? 3 : 2;
  for (int a = 0; a < 3; ++a) {
    brick.roots[a] = pick(g, most == 2 ? 1 : 2, most);
    brick.rootSize[a] = std::pow(stretch, -chance(g)) * brick.span(0);
  }
  return brick;
}

Octree randomTree(Generator& g, const Brick& brick, const SurfaceModel& model) {
  OctreeBuilder builder(brick, model);
  for (int level = 0; level < brick.maxLevel; ++level) {
    const double share = 0.6 * chance(g);
    std::vector<Id> leaves;
    for (Id n = 0; n < builder.size(); ++n)
      if (builder.node(n).isLeaf() && builder.node(n).level == level && chance(g) < share)
        leaves.push_back(n);
    builder.split(leaves);
    builder.balance(1);
  }
  return std::move(builder).finish();
}

/// Paints a random shape, in finest cells; a leaf is in it with its centre.
class Painter {
 public:
  Painter(Generator& g, const Octree& tree) : g_(g), tree_(tree) {}

  std::vector<std::uint8_t> run() {
    painted_.assign(tree_.size(), 0);
    const int shapes = pick(g_, 1, 5);
    for (int s = 0; s < shapes; ++s) add();
    if (g_() % 3 == 0)
      for (auto& p : painted_) p = !p;
    if (g_() % 3 == 0 && tree_.size() > 100) keepOffTheSides();
    return painted_;
  }

 private:
  void add() {
    switch (g_() % 5) {
      case 0:
        return noise();
      case 1:
        return box(0, tree_.brick.extent(0));
      case 2:
        return box(1, 1);
      case 3:
        return ball();
      default:
        return walk();
    }
  }
  template <class Holds>
  void paintIf(const Holds& holds) {
    for (Id leaf = 0; leaf < tree_.size(); ++leaf) painted_[leaf] = painted_[leaf] || holds(leaf);
  }
  Vec3 centre(Id leaf) const {
    const Coord c = tree_.corner(leaf);
    return Vec3(c[0], c[1], c[2]) + Vec3::Constant(0.5 * tree_.brick.span(tree_.levels[leaf]));
  }
  Vec3 somewhere() {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = chance(g_) * tree_.brick.extent(a);
    return p;
  }
  void noise() {
    const double share = chance(g_);
    paintIf([&](Id) { return chance(g_) < share; });
  }
  /// Of random edges along two axes, of thinnest .. thickest along the third.
  void box(int thinnest, int thickest) {
    const int thin = pick(g_, 0, 2);
    const Vec3 lo = somewhere();
    Vec3 size = somewhere();
    size[thin] = pick(g_, thinnest, thickest);
    paintIf([&](Id leaf) {
      const Vec3 p = centre(leaf) - lo;
      return (p.array() >= 0).all() && (p.array() <= size.array()).all();
    });
  }
  void ball() {
    const Vec3 middle = somewhere();
    const double radius = 0.7 + 3 * chance(g_);
    paintIf([&](Id leaf) { return (centre(leaf) - middle).norm() < radius; });
  }
  /// Leaf by leaf across random sides: snakes, corners and rings one cell thick.
  void walk() {
    Id leaf = static_cast<Id>(g_() % tree_.size());
    std::array<Id, 4> next;
    for (int step = pick(g_, 2, 40); step > 0; --step) {
      painted_[leaf] = 1;
      const int count = tree_.faceNeighbours(leaf, pick(g_, 0, 5), next);
      if (count > 0) leaf = next[g_() % count];
    }
  }
  void keepOffTheSides() {
    std::array<Id, 4> n;
    for (Id leaf = 0; leaf < tree_.size(); ++leaf)
      for (int side = 0; side < 6; ++side)
        if (tree_.faceNeighbours(leaf, side, n) == 0) painted_[leaf] = 0;
  }

  Generator& g_;
  const Octree& tree_;
  std::vector<std::uint8_t> painted_;
};

}  // namespace

RandomDomain randomDomain(unsigned seed, double stretch) {
  Generator g(seed);
  RandomDomain d;
  const Brick brick = randomBrick(g, stretch);
  const Vec3 far = brick.position({brick.extent(0), brick.extent(1), brick.extent(2)});
  Soup soup;
  soup.add(far + Vec3(1, 1, 1), far + Vec3(2, 1, 1), far + Vec3(1, 2, 1));  // touches nothing
  for (int t = pick(g, 0, 4); t > 2; --t)
    soup.add(randomPoint(g).cwiseProduct(far), randomPoint(g).cwiseProduct(far),
             randomPoint(g).cwiseProduct(far));
  d.model = soup.model();
  d.tree = randomTree(g, brick, *d.model);
  d.painted = Painter(g, d.tree).run();
  const double cuttable = chance(g);  // what repair may paint
  for (Id leaf = 0; leaf < d.tree.size(); ++leaf)
    d.tree.cut[leaf] = d.tree.cut[leaf] || (!d.painted[leaf] && chance(g) < 2 * cuttable);
  return d;
}

RepairedFront repairedFront(const RandomDomain& domain, bool fill) {
  RepairedFront front;
  front.painted = domain.painted;
  std::vector<Id> regionOf = connectedLeaves(domain.tree, front.painted);
  FrontRepair repair(domain.tree, *domain.model, front.painted, regionOf);
  Monitor monitor;
  if (fill) repair.fill();
  repair.clean(monitor, front.report);
  if (std::count(front.painted.begin(), front.painted.end(), 1) > 0)
    front.mesh = frontMesh(domain.tree, front.painted, *domain.model);
  return front;
}

std::vector<unsigned> frontPatterns(const Octree& tree, const std::vector<std::uint8_t>& painted) {
  std::vector<unsigned> patterns;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    if (!painted[leaf]) continue;
    const std::int32_t span = tree.brick.span(tree.levels[leaf]);
    for (int corner = 0; corner < 8; ++corner) {
      Coord node = tree.corner(leaf);
      for (int a = 0; a < 3; ++a) node[a] += (corner >> a & 1) * span;
      unsigned octants = 0;
      bool inside = true;
      for (int k = 0; k < 8; ++k) {
        const Id at = tree.find({node[0] - 1 + (k & 1), node[1] - 1 + (k >> 1 & 1), node[2] - 1 + (k >> 2)});
        inside = inside && at != kNone;
        if (at != kNone && painted[at]) octants |= 1u << k;
      }
      if (inside && octants != 255) patterns.push_back(octants);
    }
  }
  return patterns;
}

std::string whatIsWrong(const PolyMesh& mesh, const QualityLimits& limits) {
  const std::string topology = checkTopology(mesh);
  if (!topology.empty()) return topology;
  const MeshMeasures m = measure(mesh);
  return summarise(mesh, m, limits).violations == 0 ? "" : describeViolations(mesh, m, limits);
}

}  // namespace pm::testing
