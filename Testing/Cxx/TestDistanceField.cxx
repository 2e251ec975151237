// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "DistanceField.h"
#include "TestSurfaces.h"

namespace pm {
namespace {

using testing::randomPoint;
using testing::randomSoup;
using testing::Soup;

std::vector<Vec3> somePoints(const Box& box, int count, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i)
    out.push_back(box.lo + randomPoint(generator, -0.5, 1.5).cwiseProduct(box.size()));
  return out;
}

void expectExact(const DistanceField& field, const std::vector<Vec3>& points) {
  for (const Vec3& p : points) {
    const Closest found = field.closest(p), expected = field.model().closest(p);
    ASSERT_EQ(found.triangle, expected.triangle);
    ASSERT_EQ(found.distance2, expected.distance2);
    ASSERT_EQ(found.point, expected.point);
  }
}

/// A file of the running test's own (tests run side by side), gone when it is over.
struct TemporaryFile {
  std::string path = fmt::format("{}{}-{}.vdb", ::testing::TempDir(),
                                 ::testing::UnitTest::GetInstance()->current_test_info()->name(), ::getpid());
  ~TemporaryFile() { std::remove(path.c_str()); }
};

TEST(DistanceField, ColdWarmAndDisabledAnswerTheSame) {
  for (double scale : {1.0, 1e-30, 1e30}) {
    const auto place = [&](const Vec3& p) { return Vec3(scale * (p + Vec3(500, 4800, 1))); };
    const auto model = randomSoup(3000, 0.1, 1, 6).mapped(place).model();
    const auto points = somePoints(model->bounds(), 3000, 2);
    const DistanceField disabled(*model, 0.05 * scale, false);
    DistanceField field(*model, 0.05 * scale);
    expectExact(disabled, points);
    expectExact(field, points);
    EXPECT_EQ(field.activeVoxels(), 0u);
    field.fill(points);
    EXPECT_GT(field.activeVoxels(), 1000u);
    EXPECT_EQ(disabled.activeVoxels(), 0u);
    expectExact(field, points);
    expectExact(field, somePoints(model->bounds(), 3000, 3));
  }
}

TEST(DistanceField, FillsTheVoxelsOfThePointsOnce) {
  const auto model = testing::cube().model();
  DistanceField field(*model, 0.25);
  std::vector<Vec3> points;
  for (double x : {-0.9, -0.3, 0.1, 0.2, 3.0})
    for (double y : {0.1, 0.15}) points.push_back({x, y, 0.5001});
  field.fill(points);
  EXPECT_EQ(field.activeVoxels(), 4u);  // 0.1 and 0.2 share one
  field.fill(points);
  EXPECT_EQ(field.activeVoxels(), 4u);
  field.fill({{10, 10, 10}});
  EXPECT_EQ(field.activeVoxels(), 5u);
  EXPECT_GT(field.memoryBytes(), 0u);
}

TEST(DistanceField, PointsBeyondItsReachAreAnsweredToo) {
  const auto model = testing::cube().model();
  DistanceField field(*model, 1e-6);
  const std::vector<Vec3> points{{0.5, 0.5, 1.25}, {1e4, 0, 0}, {-1e30, 0, 0}, {0, 1e9, 0}};
  field.fill(points);
  EXPECT_EQ(field.activeVoxels(), 1u);
  expectExact(field, points);
  EXPECT_EQ(field.closest({std::nan(""), 0, 0}).triangle, kNone);
}

TEST(DistanceField, RefusesVoxelsWithoutSize) {
  const auto model = testing::cube().model();
  for (double size : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(DistanceField(*model, size), InputError);
}

TEST(DistanceField, ComesBackFromAFile) {
  const TemporaryFile file;
  const auto model = randomSoup(500, 0.1, 4).model();
  const auto points = somePoints(model->bounds(), 2000, 5);
  DistanceField field(*model, 0.05);
  field.fill(points);
  field.save(file.path);

  DistanceField again(*model, 0.05);
  ASSERT_TRUE(again.load(file.path));
  EXPECT_EQ(again.activeVoxels(), field.activeVoxels());
  expectExact(again, points);
  again.fill(points);
  EXPECT_EQ(again.activeVoxels(), field.activeVoxels());
}

TEST(DistanceField, RefusesAFileOfAnotherGeometryOrSize) {
  const TemporaryFile file;
  const auto model = randomSoup(500, 0.1, 4).model(), other = randomSoup(500, 0.1, 5).model();
  DistanceField field(*model, 0.05);
  field.fill(somePoints(model->bounds(), 100, 6));
  field.save(file.path);
  for (const auto& [geometry, size] : {std::pair{other.get(), 0.05}, std::pair{model.get(), 0.06}}) {
    DistanceField fresh(*geometry, size);
    fresh.fill({{0.5, 0.5, 0.5}});
    EXPECT_FALSE(fresh.load(file.path));
    EXPECT_EQ(fresh.activeVoxels(), 1u);
  }
  EXPECT_FALSE(DistanceField(*model, 0.05).load(file.path + ".missing"));
  std::ofstream(file.path) << "not a volume";
  EXPECT_FALSE(DistanceField(*model, 0.05).load(file.path));
}

TEST(DistanceField, CutFileIsACacheThatIsNotThere) {
  const TemporaryFile file;
  const auto model = randomSoup(500, 0.1, 4).model();
  DistanceField field(*model, 0.05);
  field.fill(somePoints(model->bounds(), 2000, 6));
  field.save(file.path);
  const auto size = std::filesystem::file_size(file.path);
  for (const double part : {0.9, 0.5, 0.1, 0.0}) {
    std::filesystem::resize_file(file.path, static_cast<std::uintmax_t>(part * static_cast<double>(size)));
    EXPECT_FALSE(DistanceField(*model, 0.05).load(file.path)) << part;
  }
}

TEST(DistanceField, SaysWhyItCannotSave) {
  const auto model = testing::cube().model();
  EXPECT_THROW(DistanceField(*model, 0.1, false).save("unused.vdb"), InputError);
  EXPECT_THROW(DistanceField(*model, 0.1).save("/nonexistent/folder/field.vdb"), InputError);
}

TEST(DistanceField, SameVoxelsForAnyNumberOfThreads) {
  const auto model = randomSoup(3000, 0.1, 7).model();
  const auto points = somePoints(model->bounds(), 5000, 8);
  std::set<std::size_t> counts;
  for (int threads : {1, 2, 4})
    testing::withThreads(threads, [&] {
      DistanceField field(*model, 0.02);
      field.fill(points);
      counts.insert(field.activeVoxels());
      expectExact(field, points);
    });
  EXPECT_EQ(counts.size(), 1u);
}

}  // namespace
}  // namespace pm
