// SPDX-License-Identifier: BSD-3-Clause
// Places too thin for whole leaves to hang together by faces.
#include "ThinPlaces.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <set>

#include "NarrowPassages.h"
#include "PaintFront.h"
#include "Regions.h"
#include "TestOctrees.h"
#include "TestRooms.h"

namespace {

using namespace pm;
using namespace pm::testing;

std::vector<Id> freeSets(const Octree& tree) {
  std::vector<std::uint8_t> free(tree.size());
  for (Id leaf = 0; leaf < tree.size(); ++leaf) free[leaf] = !tree.cut[leaf];
  return connectedLeaves(tree, free);
}

std::vector<Id> joined(const Octree& tree, const SurfaceModel& model) {
  std::vector<Id> sets = freeSets(tree);
  joinThinPlaces(tree, model, sets);
  return sets;
}

/// Numbers of the free leaves' sets whose centres `inside` holds.
std::set<Id> setsWhere(const Octree& tree, const std::vector<Id>& setOf,
                       const std::function<bool(const Vec3&)>& inside) {
  std::set<Id> sets;
  for (Id leaf = 0; leaf < tree.size(); ++leaf)
    if (!tree.cut[leaf] && inside(tree.box(leaf).centre())) sets.insert(setOf[leaf]);
  return sets;
}

/// Points less edges plus faces of the boundary.
Id eulerNumber(const PolyMesh& mesh) {
  std::set<Id> points;
  std::set<std::pair<Id, Id>> edges;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    for (std::size_t i = 0; i < row.size(); ++i) {
      points.insert(row[i]);
      edges.insert(std::minmax(row[i], row[(i + 1) % row.size()]));
    }
  }
  return static_cast<Id>(points.size() + (mesh.faceCount() - mesh.internalFaces()) - edges.size());
}

/// Cells of this size on all of the surface.
Octree fineEverywhere(const SurfaceModel& model, double size) {
  OctreeDecomposeOptions o = bare(size);
  o.surfaceSize = size;
  return run(model, o);
}

/// A block with a corner in the origin, turned; above the floor another one where there is `upper`.
struct Slab {
  Vec3 size;
  double upper = 0;
  Eigen::Quaterniond turn;

  std::unique_ptr<SurfaceModel> model() const {
    std::vector<double> z{0, size[2]};
    if (upper > 0) z.push_back(size[2] + upper);
    const Soup soup = rooms({std::vector<double>{0, size[0]}, {0, size[1]}, z}, upper > 0 ? 2 : 1,
                            [&](const Vec3& c) { return c[2] < size[2] ? 1 : 2; });
    return soup.mapped([&](const Vec3& p) { return Vec3(turn * p); }).model();
  }
  bool holds(const Vec3& p) const {
    const Vec3 q = turn.conjugate() * p;
    return q.minCoeff() > 0 && (q.array() < size.array()).all();
  }
  Vec3 across() const { return turn * Vec3::UnitZ(); }
};

/// Whole leaves surely hang together where this is 1.
double width(const Slab& slab, double size, double part) {
  return part * size / featureSizeShowing(1, slab.across());
}

Eigen::Quaterniond randomTurn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

// What more than one cut leaf parts stays apart: in some slabs nearly along the axes.
TEST(ThinPlaces, ObliqueSlabsAreJoined) {
  constexpr double kSize = 0.05;
  std::mt19937 random(5);
  int torn = 0, left = 0;
  for (int i = 0; i < 40; ++i) {
    Slab slab{Vec3(1, 1, 0), 0, randomTurn(random)};
    slab.size[2] = width(slab, kSize, 0.8 + 0.005 * i);
    const auto model = slab.model();
    const Octree tree = fineEverywhere(*model, kSize);
    const auto inside = [&](const Vec3& p) { return slab.holds(p); };
    torn += setsWhere(tree, freeSets(tree), inside).size() > 1;
    left += setsWhere(tree, joined(tree, *model), inside).size() > 1;
  }
  EXPECT_GT(torn, 20);
  EXPECT_LT(left, torn / 2);
}

// Then no hole narrower than a leaf is passed.
TEST(ThinPlaces, WaysThroughLinksKeepHalfALeafAway) {
  Id links = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto model = randomSoup(100, 0.5, seed).model();
    const Octree tree = fineEverywhere(*model, 0.05);
    const std::vector<Id> before = freeSets(tree), after = joined(tree, *model);
    for (Id leaf = 0; leaf < tree.size(); ++leaf) {
      if (!tree.cut[leaf] || after[leaf] == kNone) continue;
      ++links;
      std::array<Id, 4> n;
      std::set<Id> linked;
      const Vec3 centre = tree.box(leaf).centre();
      for (int side = 0; side < 6; ++side)
        for (int k = tree.faceNeighbours(leaf, side, n); k-- > 0;) {
          if (after[n[k]] != after[leaf]) continue;
          EXPECT_FALSE(model->crosses(centre, tree.box(n[k]).centre()));
          const Vec3 way = tree.box(n[k]).centre() - centre;
          double least = 1;
          for (int i = 0; i <= 20; ++i)
            least = std::min(least, model->closest(centre + 0.05 * i * way).distance2);
          if (least > std::pow(0.49 * tree.brick.edge(tree.levels[leaf]), 2))
            linked.insert(tree.cut[n[k]] ? -n[k] : before[n[k]]);
        }
      EXPECT_GT(linked.size(), 1u) << seed;
    }
  }
  EXPECT_GT(links, 20);
}

TEST(ThinPlaces, ASheetPartsThem) {
  constexpr double kSize = 0.05;
  std::mt19937 random(8);
  for (int i = 0; i < 20; ++i) {
    Slab slab{Vec3(1, 1, 0), 0, randomTurn(random)};
    slab.size[2] = slab.upper = width(slab, kSize, 0.85);
    const auto model = slab.model();
    const Octree tree = fineEverywhere(*model, kSize);
    const std::vector<Id> sets = joined(tree, *model);
    Slab other = slab;
    other.size[2] += slab.upper;
    const auto below = [&](const Vec3& p) { return slab.holds(p); };
    const auto above = [&](const Vec3& p) { return !slab.holds(p) && other.holds(p); };
    const auto outside = [&](const Vec3& p) { return !other.holds(p); };
    for (Id set : setsWhere(tree, sets, below)) {
      EXPECT_EQ(setsWhere(tree, sets, above).count(set), 0u) << i;
      EXPECT_EQ(setsWhere(tree, sets, outside).count(set), 0u) << i;
    }
    for (Id leaf = 0; leaf < tree.size(); ++leaf) {  // links see all that is beside them
      std::array<Id, 4> n;
      for (int side = 0; side < 6 && sets[leaf] != kNone; ++side)
        for (int k = tree.faceNeighbours(leaf, side, n); k-- > 0;) {
          const bool crossed = model->crosses(tree.box(leaf).centre(), tree.box(n[k]).centre());
          EXPECT_FALSE(crossed && sets[n[k]] == sets[leaf]) << i;
        }
    }
  }
}

// A slot between two rooms holds leaves here and there. It may go to either, but joins them only where whole
// leaves do.
TEST(ThinPlaces, RoomsStayApart) {
  constexpr double kSize = 0.05;
  int slots = 0;
  for (int i = 0; i < 40; ++i) {
    const double floor = 0.4 + 0.0131 * (i % 7), height = (0.8 + 0.03 * i) * kSize;
    const auto model =
        rooms({std::vector<double>{0.011, 1, 1.6, 2.6}, {0, 1}, {0, floor, floor + height, 1}}, 1,
              [&](const Vec3& c) {
                const bool slot = c[2] > floor && c[2] < floor + height;
                return c[0] < 1 || c[0] > 1.6 || slot ? 1 : 0;
              })
            .mapped([](const Vec3& p) { return Vec3(Eigen::AngleAxisd(0.2, Vec3::UnitY()) * p); })
            .model();
    const Octree tree = fineEverywhere(*model, kSize);
    const auto at = [&](double x) {
      return tree.locate(Eigen::AngleAxisd(0.2, Vec3::UnitY()) * Vec3(x, 0.5, 0.3));
    };
    const std::vector<Id> before = freeSets(tree), after = joined(tree, *model);
    ASSERT_NE(before[at(0.5)], kNone);
    if (before[at(0.5)] == before[at(2.1)]) continue;
    ++slots;
    EXPECT_NE(after[at(0.5)], after[at(2.1)]) << i;
    EXPECT_NE(after[at(0.5)], after[0]) << "the outside";
    EXPECT_NE(after[at(2.1)], after[0]);
  }
  EXPECT_GT(slots, 20);
}

TEST(ThinPlaces, AreTheSameOnAnyNumberOfThreads) {
  std::mt19937 random(2);
  Slab slab{Vec3(1, 1, 0), 0, randomTurn(random)};
  slab.size[2] = width(slab, 0.03, 0.85);
  const auto model = slab.model();
  const Octree tree = fineEverywhere(*model, 0.03);
  std::vector<Id> wanted;
  withThreads(1, [&] { wanted = joined(tree, *model); });
  EXPECT_NE(wanted, freeSets(tree));
  for (int threads : {2, 4}) withThreads(threads, [&] { EXPECT_EQ(joined(tree, *model), wanted); });
}

// Shells run askew to the lattice in every direction. The front is two spheres, without a hole from one to
// the other.
TEST(ThinPlaces, AShellIsNotTorn) {
  constexpr double kSize = 0.06;
  for (double thickness : {2.3, 2.4, 2.5, 2.6, 2.7, 2.8, 2.9}) {
    const auto sphere = [](double radius) {
      return cube(30).mapped(
          [&](const Vec3& p) { return Vec3(radius * (p - Vec3::Constant(0.5)).normalized()); });
    };
    Soup shell = sphere(1);
    shell.append(sphere(1 - thickness * kSize));
    const auto model = shell.model();
    Monitor monitor;
    const Octree tree = fineEverywhere(*model, kSize);
    PaintFrontOptions options;
    options.region = Region::Points;
    for (Id leaf = 0; leaf < tree.size() && options.points.empty(); ++leaf) {
      const Vec3 centre = tree.box(leaf).centre();
      const bool inShell = centre.norm() < 1 && centre.norm() > 1 - thickness * kSize;
      if (!tree.cut[leaf] && inShell) options.points.push_back(centre);
    }
    EXPECT_EQ(eulerNumber(paintFront(tree, *model, options, monitor)), 4) << thickness;
  }
}

}  // namespace
