// SPDX-License-Identifier: BSD-3-Clause
// Wall faces cut in two.
#include "WallCuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "DummyLayer.h"
#include "TestMeshes.h"
#include "TestRandomDomains.h"

namespace {

using namespace pm;
using namespace pm::testing;

std::vector<Id> cutOf(const std::vector<Id>& row, Id a, Id b, int part) {
  std::vector<Id> parts[2];
  cutRow({row.data(), row.data() + row.size()}, a, b, parts[0], parts[1]);
  return parts[part];
}

/// Every `nth` wall face of four or more points with a diagonal of its own; none for nth 0.
std::vector<WallCut> randomCuts(const PolyMesh& mesh, unsigned seed, unsigned nth) {
  std::mt19937_64 g(seed);
  std::vector<WallCut> cuts;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    const std::size_t n = row.size();
    if (!mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()]) || n < 4 || g() % nth != 0) continue;
    const std::size_t from = g() % n, step = 2 + g() % (n - 3);
    cuts.push_back({f, row[from], row[(from + step) % n]});
  }
  return cuts;
}

PolyMesh cutMesh(PolyMesh mesh, const std::vector<WallCut>& cuts) {
  cutWallFaces(mesh, cuts);
  return mesh;
}

std::vector<double> patchAreas(const PolyMesh& mesh) {
  std::vector<double> sums(mesh.patchNames.size(), 0.0);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i)
    sums[mesh.patch[i]] += measureFace(mesh.points, mesh.faces[mesh.internalFaces() + i], true).normal.norm();
  return sums;
}

/// Flat wall faces: outside a solid, inside a block, and on one side of a block.
std::vector<PolyMesh> flatWalls() {
  VoxelOptions room, block, floor;
  room.size = {5, 5, 5};
  room.wallSide = {false, false, false, false, false, false};
  room.occupied = [](int i, int j, int k) { return !(i == 2 && j > 0 && j < 3 && k == 2); };
  floor.size = {4, 3, 2};
  floor.wallSide = {false, false, false, false, false, true};
  return {layeredVoxels(room), layeredVoxels(block), layeredVoxels(floor)};
}

TEST(WallCuts, PartsOfARowFollowIt) {
  EXPECT_EQ(cutOf({5, 6, 7, 8}, 6, 8, 0), (std::vector<Id>{6, 7, 8}));
  EXPECT_EQ(cutOf({5, 6, 7, 8}, 6, 8, 1), (std::vector<Id>{8, 5, 6}));
  EXPECT_EQ(cutOf({4, 2, 9, 1, 3}, 3, 2, 0), (std::vector<Id>{3, 4, 2}));
  EXPECT_EQ(cutOf({4, 2, 9, 1, 3}, 3, 2, 1), (std::vector<Id>{2, 9, 1, 3}));
}

TEST(WallCuts, KeepCellsVolumeAndPatches) {
  unsigned seed = 0;
  for (const PolyMesh& mesh : flatWalls()) {
    ASSERT_EQ(checkTopology(mesh), "");
    const std::vector<WallCut> cuts = randomCuts(mesh, ++seed, 2);
    ASSERT_GT(cuts.size(), 3u);
    const PolyMesh cut = cutMesh(mesh, cuts);
    EXPECT_EQ(checkTopology(cut), "");
    EXPECT_EQ(cut.cellCount, mesh.cellCount);
    EXPECT_EQ(cut.faceCount(), mesh.faceCount() + static_cast<Id>(cuts.size()));
    EXPECT_EQ(cut.boundaryFaces(), mesh.boundaryFaces() + static_cast<Id>(cuts.size()));
    const MeshMeasures before = measure(mesh), after = measure(cut);
    for (Id c = 0; c < mesh.cellCount; ++c) EXPECT_NEAR(after.cells[c].volume, before.cells[c].volume, 1e-12);
    const std::vector<double> area = patchAreas(mesh), areaNow = patchAreas(cut);
    for (std::size_t i = 0; i < area.size(); ++i) EXPECT_NEAR(areaNow[i], area[i], 1e-12);
  }
}

TEST(WallCuts, LeaveTheRestAsItIs) {
  const PolyMesh mesh = flatWalls()[0];
  const std::vector<WallCut> cuts = randomCuts(mesh, 3, 3);
  const PolyMesh cut = cutMesh(mesh, cuts);
  EXPECT_TRUE(cut.points == mesh.points);
  EXPECT_TRUE(cut.neighbour == mesh.neighbour);
  auto next = cuts.begin();
  Id now = 0;
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const std::vector<Id> row(mesh.faces[f].begin(), mesh.faces[f].end());
    const bool isCut = next != cuts.end() && next->face == f;
    for (int part = 0; part < (isCut ? 2 : 1); ++part, ++now) {
      EXPECT_EQ(std::vector<Id>(cut.faces[now].begin(), cut.faces[now].end()),
                isCut ? cutOf(row, next->a, next->b, part) : row);
      EXPECT_EQ(cut.owner[now], mesh.owner[f]);
      if (f < mesh.internalFaces()) continue;
      EXPECT_EQ(cut.patch[now - mesh.internalFaces()], mesh.patch[f - mesh.internalFaces()]);
    }
    if (isCut) ++next;
  }
  EXPECT_EQ(now, cut.faceCount());
  EXPECT_EQ(checksum(cutMesh(mesh, {})), checksum(mesh));
}

TEST(WallCuts, TheFirstOfSeveralCutsOfAFaceCounts) {
  const PolyMesh mesh = flatWalls()[1];
  const std::vector<WallCut> cuts = randomCuts(mesh, 5, 2);
  std::vector<WallCut> more = cuts;
  for (const WallCut& cut : cuts) {  // the other diagonals
    const std::vector<Id> row(mesh.faces[cut.face].begin(), mesh.faces[cut.face].end());
    more.push_back({cut.face, cutOf(row, cut.a, cut.b, 0)[1], cutOf(row, cut.a, cut.b, 1)[1]});
  }
  EXPECT_EQ(checksum(cutMesh(mesh, more)), checksum(cutMesh(mesh, cuts)));
  std::rotate(more.begin(), more.begin() + static_cast<std::ptrdiff_t>(cuts.size()), more.end());
  EXPECT_NE(checksum(cutMesh(mesh, more)), checksum(cutMesh(mesh, cuts)));
}

TEST(WallCuts, ComeInAnyOrder) {
  const PolyMesh mesh = flatWalls()[0];
  std::vector<WallCut> cuts = randomCuts(mesh, 7, 1);
  const std::uint64_t sum = checksum(cutMesh(mesh, cuts));
  std::shuffle(cuts.begin(), cuts.end(), std::mt19937_64(1));
  EXPECT_EQ(checksum(cutMesh(mesh, cuts)), sum);
}

/// Calls body(mesh with a layer, cuts of it, seed) for many small domains; together they have many cuts.
template <class Body>
void forRandomMeshes(const Body& body) {
  std::size_t count = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Monitor monitor;
    PolyMesh front = repairedFront(randomDomain(seed, 1), false).mesh;
    if (front.cellCount == 0) continue;
    const PolyMesh mesh = dummyLayer(std::move(front), {}, monitor);
    const std::vector<WallCut> cuts = randomCuts(mesh, seed, 1 + seed % 4);
    count += cuts.size();
    SCOPED_TRACE("domain " + std::to_string(seed));
    body(mesh, cuts, seed);
  }
  EXPECT_GT(count, 400u);
}

TEST(WallCuts, OfRandomMeshesKeepTopologyAndCanBePutInOrder) {
  forRandomMeshes([](const PolyMesh& mesh, const std::vector<WallCut>& cuts, unsigned seed) {
    PolyMesh cut = cutMesh(mesh, cuts);
    ASSERT_EQ(checkTopology(cut), "");
    EXPECT_EQ(cut.faceCount(), mesh.faceCount() + static_cast<Id>(cuts.size()));
    PolyMesh other = shuffled(cut, seed);
    canonicalise(cut);
    canonicalise(other);
    EXPECT_EQ(checkTopology(cut), "");
    EXPECT_EQ(checksum(cut), checksum(other));
  });
}

std::uint64_t sumInOrder(PolyMesh mesh) {
  canonicalise(mesh);
  return checksum(mesh);
}

TEST(WallCuts, MergingUndoesThem) {
  forRandomMeshes([](const PolyMesh& mesh, const std::vector<WallCut>& cuts, unsigned) {
    EXPECT_TRUE(wallPairs(mesh).empty());
    PolyMesh cut = cutMesh(mesh, cuts);
    const std::vector<WallMerge> pairs = wallPairs(cut);
    EXPECT_EQ(pairs.size(), cuts.size());
    mergeWallFaces(cut, pairs);
    EXPECT_EQ(checkTopology(cut), "");
    EXPECT_EQ(sumInOrder(cut), sumInOrder(mesh));
  });
}

TEST(WallCuts, AFaceIsMergedOnce) {
  PolyMesh mesh = flatWalls()[0];
  const std::vector<WallCut> cuts = randomCuts(mesh, 3, 1);
  mesh = cutMesh(std::move(mesh), cuts);
  const auto half = static_cast<std::ptrdiff_t>(cuts.size() / 2);
  std::vector<WallMerge> pairs = wallPairs(mesh);
  std::vector<WallMerge> twice(pairs.begin(), pairs.begin() + half);
  twice.insert(twice.end(), twice.begin(), twice.end());
  const Id before = mesh.faceCount();
  mergeWallFaces(mesh, twice);
  EXPECT_EQ(mesh.faceCount(), before - half);
  EXPECT_EQ(checkTopology(mesh), "");
}

}  // namespace
