// SPDX-License-Identifier: BSD-3-Clause
// The choice of cuts that bring a wall nearer to the geometry.
#include "FittingCuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "TestMeshes.h"
#include "TestRandomDomains.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// A block whose upper side lies at height(x, y) above its offset.
PolyMesh hilly(int size, const std::function<double(double, double)>& height) {
  VoxelOptions o;
  o.size = {size, size, 2};
  o.wallSide = {false, false, false, false, false, true};
  o.deform = [&](const Vec3& p) { return p.z() <= 2 ? p : Vec3(p.x(), p.y(), p.z() + height(p.x(), p.y())); };
  return layeredVoxels(o);
}

/// A roof with its ridge (or, of negative slope, its valley) along x = y.
double roofHeight(double slope, double x, double y) { return 0.4 - slope * std::abs(x - y); }

PolyMesh roofed(double slope) {
  return hilly(4, [slope](double x, double y) { return roofHeight(slope, x, y); });
}

Soup roof(double slope) {
  const double top = 2 + 1.0 / 3 + roofHeight(slope, 0, 0), side = 2 + 1.0 / 3 + roofHeight(slope, 4, 0);
  Soup soup;
  soup.add({0, 0, top}, {4, 0, side}, {4, 4, top});
  soup.add({0, 0, top}, {4, 4, top}, {0, 4, side});
  return soup;
}

TEST(FittingCuts, FollowARidgeAndAValley) {
  for (const double slope : {0.15, -0.15}) {
    PolyMesh mesh = roofed(slope);
    ASSERT_EQ(whatIsWrong(mesh), "");
    const auto model = roof(slope).model();
    DistanceField field(*model, 1);
    const NodeMover mover(mesh, {});
    const std::vector<WallCut> cuts = fittingCuts(mover, field);
    EXPECT_EQ(cuts.size(), 4u);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const Vec3 &a = mesh.points[cuts[i].a], &b = mesh.points[cuts[i].b];
      EXPECT_EQ(a.x(), a.y());
      EXPECT_EQ(b.x(), b.y());
      if (i > 0) {
        EXPECT_LT(cuts[i - 1].face, cuts[i].face);
      }
    }
    PolyMesh cut = mesh;
    cutWallFaces(cut, cuts);
    EXPECT_EQ(whatIsWrong(cut), "");
    for (Id f = cut.internalFaces(); f < cut.faceCount(); ++f) {
      if (!cut.isWallPatch(cut.patch[f - cut.internalFaces()])) continue;
      EXPECT_LT(field.closest(measureFace(cut.points, cut.faces[f], true).centre).distance2, 1e-20);
    }
  }
}

TEST(FittingCuts, KeepTheLimitsAndLeaveFlatFacesAlone) {
  PolyMesh flat = roofed(0), folded = roofed(0.15);
  const auto model = roof(0.15).model(), plane = roof(0).model();
  DistanceField field(*model, 1), flatField(*plane, 1);
  EXPECT_TRUE(fittingCuts(NodeMover(flat, {}), flatField).empty());
  QualityLimits strict;
  strict.minEtaBoundary = 0.99;  // of no triangle that is half a square
  EXPECT_TRUE(fittingCuts(NodeMover(folded, strict), field).empty());
}

/// A cut through every wall face, along x = y where that goes, else across.
std::vector<WallCut> allCuts(const PolyMesh& mesh, bool along) {
  std::vector<WallCut> cuts;
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    if (!mesh.isWallPatch(mesh.patch[i])) continue;
    const Id f = mesh.internalFaces() + i;
    const Span<Id> row = mesh.faces[f];
    const auto slope = [&](int k) {
      const Vec3 d = mesh.points[row[k]] - mesh.points[row[k + 2]];
      return d.x() * d.y();
    };
    const int k = (slope(0) > 0) == along ? 0 : 1;
    cuts.push_back({f, row[k], row[k + 2]});
  }
  return cuts;
}

TEST(FittingCuts, ThoseThatBringNothingAreUndone) {
  for (bool along : {true, false}) {
    PolyMesh mesh = roofed(0.15);
    const Id uncut = mesh.boundaryFaces();
    const auto model = roof(0.15).model();
    DistanceField field(*model, 1);
    cutWallFaces(mesh, allCuts(mesh, along));
    EXPECT_TRUE(needlessCuts(NodeMover(mesh, {}), field, [](Id, Id) { return true; }).empty());
    for (;;) {
      const std::vector<WallMerge> merges =
          needlessCuts(NodeMover(mesh, {}), field, [](Id, Id) { return false; });
      if (merges.empty()) break;
      EXPECT_LE(merges.size(), 8u) << "of 16 squares no two side by side";
      mergeWallFaces(mesh, merges);
    }
    // Of the 16 cuts only the four on the ridge bring faces nearer; across it all are in vain.
    EXPECT_EQ(mesh.boundaryFaces(), uncut + (along ? 4 : 0));
    EXPECT_EQ(whatIsWrong(mesh), "");
  }
}

TEST(FittingCuts, LeaveFacesThatOnlyBend) {
  for (const double slope : {0.1, 0.15}) {  // folds of 16 and of 24 degrees
    PolyMesh mesh = roofed(slope);
    mesh.finestSize = 0.5;
    const auto model = roof(slope).model();
    DistanceField field(*model, 1);
    EXPECT_EQ(fittingCuts(NodeMover(mesh, {}), field).size(), slope > 0.12 ? 4u : 0u);
  }
}

TEST(FittingCuts, FindTheDiagonalsOfTheGeometryOnAnyNumberOfThreads) {
  constexpr int kSize = 24;
  std::mt19937_64 g(9);
  std::vector<double> heights;
  for (int i = 0; i <= kSize * (kSize + 2); ++i) heights.push_back(0.15 * randomPoint(g, -1, 1)[0]);
  const auto height = [&](double x, double y) {
    return heights[static_cast<std::size_t>(y * (kSize + 1) + x)];
  };
  PolyMesh mesh = hilly(kSize, height);
  ASSERT_EQ(whatIsWrong(mesh), "");
  Soup soup;  // the same hills, each square in two triangles
  const auto at = [&](int i, int j) { return Vec3(i, j, 2 + 1.0 / 3 + height(i, j)); };
  for (int i = 0; i < kSize; ++i)
    for (int j = 0; j < kSize; ++j) {
      const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      const bool turned = (i + j) % 3 == 0;
      soup.add(a, b, turned ? d : c);
      soup.add(turned ? b : a, c, d);
    }
  const auto model = soup.model();
  DistanceField field(*model, 1);
  std::vector<std::vector<WallCut>> results;
  for (int threads : {1, 2, 4})
    withThreads(threads, [&] { results.push_back(fittingCuts(NodeMover(mesh, {}), field)); });
  EXPECT_GT(results[0].size(), 50u);
  for (const WallCut& cut : results[0])
    EXPECT_LT(field.closest(0.5 * (mesh.points[cut.a] + mesh.points[cut.b])).distance2, 1e-20);
  for (const auto& cuts : results)
    EXPECT_TRUE(std::equal(
        cuts.begin(), cuts.end(), results[0].begin(), results[0].end(),
        [](const WallCut& x, const WallCut& y) { return x.face == y.face && x.a == y.a && x.b == y.b; }));
}

}  // namespace
