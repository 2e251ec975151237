// SPDX-License-Identifier: BSD-3-Clause
// Wall nodes on the geometry, every limit kept, the same bits for any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "Project.h"
#include "TestLayered.h"

namespace {

using namespace pm;
using namespace pm::testing;

PolyMesh projected(const SurfaceModel& model, double size, bool cache = true) {
  Monitor monitor;
  PolyMesh mesh = layered(model, size);
  DistanceField field(model, mesh.finestSize, cache);
  project(mesh, field, {}, monitor);
  return mesh;
}

/// Share of wall points within the distance of the geometry.
double within(const PolyMesh& mesh, const SurfaceModel& model, double distance) {
  Id near = 0, all = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (mesh.base[p] == kNone) continue;
    ++all;
    near += std::sqrt(model.closest(mesh.points[p]).distance2) <= distance;
  }
  return double(near) / all;
}

TEST(Project, ACylindersWallIsOnTheCylinder) {
  const auto model = cylinder(64).model();
  const PolyMesh mesh = projected(*model, 0.1);
  EXPECT_EQ(checkTopology(mesh), "");
  const MeshMeasures m = measure(mesh);
  const QualitySummary q = summarise(mesh, m, {});
  EXPECT_EQ(q.violations, 0) << describeViolations(mesh, m, {});
  EXPECT_GT(within(mesh, *model, 1e-3 * 0.1), 0.999);
  EXPECT_NEAR(q.totalVolume, 2 * 3.14159, 0.03 * 2 * 3.14159);
  EXPECT_EQ(mesh.stage, Stage::Projected);
}

TEST(Project, SaysWhatHoldsANodeThatStaysShort) {
  const auto model = cylinder(64).model();
  Monitor monitor;
  PolyMesh free = layered(*model, 0.1), held = free;
  DistanceField field(*model, free.finestSize);
  std::vector<StuckNode> none, stuck;
  project(free, field, {}, monitor, &none);
  EXPECT_TRUE(none.empty());
  // Faces that may not warp cannot follow a curved wall.
  ProjectOptions stiff;
  stiff.limits.maxWarpage = 2;
  project(held, field, stiff, monitor, &stuck);
  ASSERT_FALSE(stuck.empty());
  EXPECT_TRUE(std::any_of(stuck.begin(), stuck.end(),
                          [](const StuckNode& s) { return s.heldBy == std::string("warpage of a face"); }));
  for (const StuckNode& s : stuck) {
    EXPECT_GT(s.distance, 0.005 * 0.1);
    EXPECT_NEAR(s.distance, std::sqrt(model->closest(s.position).distance2), 1e-12);
    EXPECT_EQ(std::count(held.points.begin(), held.points.end(), s.position), 1);
  }
  // Whoever is not told of is there.
  const double told = 1 - double(stuck.size()) / std::count_if(held.base.begin(), held.base.end(),
                                                               [](Id b) { return b != kNone; });
  EXPECT_GE(within(held, *model, 0.02 * 0.1), told - 1e-12);
}

TEST(Project, ADirtySoupStillEndsValid) {
  // A cylinder whose triangles are all shaken apart by a fifth of a cell and half of them flipped.
  Soup soup = cylinder(48).flipped(3);
  std::mt19937_64 g(4);
  Soup dirty;
  for (const auto& t : soup.triangles) {
    const Vec3 shift = 0.02 * randomPoint(g, -1, 1);
    dirty.add(soup.points[t[0]] + shift, soup.points[t[1]] + shift, soup.points[t[2]] + shift);
  }
  const auto model = dirty.model();
  const PolyMesh mesh = projected(*model, 0.1);
  const MeshMeasures m = measure(mesh);
  EXPECT_EQ(summarise(mesh, m, {}).violations, 0) << describeViolations(mesh, m, {});
  EXPECT_GT(within(mesh, *model, 0.05 * 0.1), 0.95);
}

/// A block with a V-shaped groove along y in its top, 1.6 wide and 1.2 deep, turned about z.
Soup groovedBlock(double angle) {
  const std::vector<std::array<double, 2>> outline = {{-2, -2},  {2, -2},   {2, 1}, {0.8, 1},
                                                      {0, -0.2}, {-0.8, 1}, {-2, 1}};
  Soup soup;
  const auto at = [&](std::size_t i, double y) {
    const auto [x, z] = outline[i % outline.size()];
    return Vec3(std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y, z);
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    soup.add(at(i, -2), at(i + 1, -2), at(i + 1, 2));
    soup.add(at(i, -2), at(i + 1, 2), at(i, 2));
  }
  for (double y : {-2.0, 2.0})
    for (const std::array<std::size_t, 3>& t :
         {std::array<std::size_t, 3>{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {4, 5, 6}, {6, 0, 4}})
      soup.add(at(t[0], y), at(t[1], y), at(t[2], y));
  return soup;
}

TEST(Project, WebsAreDrawnIntoTheirGaps) {
  // The mesh around the block; how far above the groove's bottom does it end?
  double sum = 0;
  for (int k = 0; k < 6; ++k) {
    const auto model = groovedBlock(0.1 + 0.2 * k).model();
    Monitor monitor;
    PolyMesh mesh = layered(*model, 0.4, Region::Outside);
    DistanceField field(*model, mesh.finestSize);
    project(mesh, field, {}, monitor);
    const MeshMeasures m = measure(mesh);
    EXPECT_EQ(summarise(mesh, m, {}).violations, 0) << describeViolations(mesh, m, {});
    double lowest = 1;
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
      if (mesh.base[p] != kNone && mesh.points[p].head<2>().norm() < 1.2)
        lowest = std::min(lowest, std::abs(mesh.points[p].z() + 0.2));
    sum += lowest / mesh.finestSize;
  }
  EXPECT_LT(sum / 6, 0.3) << "without the pull of webs it is 0.43";
}

TEST(Project, SameBitsForAnyThreadCountAndWithoutTheCache) {
  const auto model = cylinder(40).model();
  std::uint64_t one = 0, three = 0, uncached = 0;
  withThreads(1, [&] { one = checksum(projected(*model, 0.12)); });
  withThreads(3, [&] { three = checksum(projected(*model, 0.12)); });
  withThreads(2, [&] { uncached = checksum(projected(*model, 0.12, false)); });
  EXPECT_EQ(one, three);
  EXPECT_EQ(one, uncached);
}

TEST(Project, StopsWhenAsked) {
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  const auto model = cylinder(32).model();
  PolyMesh mesh = layered(*model, 0.2);
  DistanceField field(*model, mesh.finestSize);
  EXPECT_THROW(project(mesh, field, {}, stop), AbortError);
}

}  // namespace
