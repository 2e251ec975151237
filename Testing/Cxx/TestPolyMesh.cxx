// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "TestMeshes.h"

namespace pm {
namespace {

using testing::layeredVoxels;
using testing::shuffled;
using testing::VoxelOptions;

PolyMesh block() {
  VoxelOptions o;
  o.size = {4, 3, 2};
  o.wallSide = {false, false, false, false, false, true};
  return layeredVoxels(o);
}

PolyMesh withHole() {
  VoxelOptions o;
  o.size = {5, 4, 4};
  o.occupied = [](int i, int j, int k) { return !(i == 2 && j > 0 && j < 3 && k == 1); };
  return layeredVoxels(o);
}

void expectEqual(const PolyMesh& a, const PolyMesh& b) {
  EXPECT_EQ(a.faces.offsets, b.faces.offsets);
  EXPECT_EQ(a.faces.values, b.faces.values);
  EXPECT_EQ(a.owner, b.owner);
  EXPECT_EQ(a.neighbour, b.neighbour);
  EXPECT_EQ(a.patch, b.patch);
}

TEST(PolyMesh, BlockHasTheCountsOfItsGrid) {
  const PolyMesh mesh = block();
  EXPECT_EQ(checkTopology(mesh), "");
  EXPECT_EQ(mesh.cellCount, 4 * 3 * 3);
  EXPECT_EQ(mesh.points.size(), 5u * 4 * 4);
  EXPECT_EQ(mesh.internalFaces(), 3 * 3 * 3 + 4 * 2 * 3 + 4 * 3 * 2);
  EXPECT_EQ(mesh.boundaryFaces(), 2 * (4 * 3 + 4 * 3 + 3 * 3));
}

TEST(PolyMesh, CanonicalOrderIsSortedAndIdempotent) {
  const PolyMesh mesh = withHole();
  ASSERT_EQ(checkTopology(mesh), "");
  const auto key = [&](Id f) {
    std::vector<Id> k{mesh.owner[f]};
    if (f < mesh.internalFaces()) k.push_back(mesh.neighbour[f]);
    k.insert(k.end(), mesh.faces[f].begin(), mesh.faces[f].end());
    return k;
  };
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    EXPECT_EQ(row[0], *std::min_element(row.begin(), row.end()));
    if (f + 1 == mesh.faceCount() || f + 1 == mesh.internalFaces()) continue;
    EXPECT_LT(key(f), key(f + 1));
  }
  PolyMesh again = mesh;
  canonicalise(again);
  expectEqual(mesh, again);
}

TEST(PolyMesh, CanonicalOrderForgetsTheOrderBefore) {
  for (const PolyMesh& mesh : {block(), withHole()}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      PolyMesh other = shuffled(mesh, seed);
      ASSERT_NE(other.faces.values, mesh.faces.values);
      canonicalise(other);
      expectEqual(mesh, other);
      EXPECT_EQ(checksum(mesh), checksum(other));
    }
  }
}

/// Cells in their order, but the faces of each the other way round, as a reader of cells may find them.
PolyMesh reversedWithinCells(const PolyMesh& mesh) {
  PolyMesh out = mesh;
  out.faces.clear();
  const Id internal = mesh.internalFaces();
  for (Id first = 0, last; first < mesh.faceCount(); first = last) {
    const Id end = first < internal ? internal : mesh.faceCount();
    for (last = first; last < end && mesh.owner[last] == mesh.owner[first];) ++last;
    for (Id i = first; i < last; ++i) {
      const Id f = last - 1 - (i - first);
      out.faces.push(mesh.faces[f]);
      if (i < internal) out.neighbour[i] = mesh.neighbour[f];
      if (i >= internal) out.patch[i - internal] = mesh.patch[f - internal];
    }
  }
  return out;
}

TEST(PolyMesh, FacesOutOfOrderWithinTheirCells) {
  for (const PolyMesh& mesh : {block(), withHole()}) {
    PolyMesh other = reversedWithinCells(mesh);
    ASSERT_NE(other.faces.values, mesh.faces.values);
    ASSERT_NE(other.neighbour, mesh.neighbour);
    canonicalise(other);
    expectEqual(mesh, other);
  }
}

TEST(PolyMesh, BoundaryFacesKeepPatchAndOrientation) {
  PolyMesh mesh = shuffled(block(), 7);
  canonicalise(mesh);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    const Span<Id> row = mesh.faces[mesh.internalFaces() + i];
    const int side = mesh.patch[i] == 0 ? 5 : mesh.patch[i] - 1;  // wall on top
    const Vec3 e = mesh.points[row[1]] - mesh.points[row[0]], g = mesh.points[row[2]] - mesh.points[row[0]];
    const int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
    EXPECT_GT((e[b] * g[c] - e[c] * g[b]) * (side % 2 ? 1 : -1), 0);
  }
}

TEST(PolyMesh, AdjacencyAgreesWithTheFaces) {
  const PolyMesh mesh = withHole();
  std::vector<std::set<Id>> cells(mesh.points.size()), faces(mesh.points.size()), ofCell(mesh.cellCount);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    ofCell[mesh.owner[f]].insert(f);
    if (f < mesh.internalFaces()) ofCell[mesh.neighbour[f]].insert(f);
    for (Id p : mesh.faces[f]) {
      faces[p].insert(f);
      cells[p].insert(mesh.owner[f]);
      if (f < mesh.internalFaces()) cells[p].insert(mesh.neighbour[f]);
    }
  }
  const Csr<Id> pc = pointCells(mesh, cellFaces(mesh)), pf = pointFaces(mesh), cf = cellFaces(mesh);
  const auto same = [](const Csr<Id>& rows, const std::vector<std::set<Id>>& sets) {
    ASSERT_EQ(rows.rows(), static_cast<Id>(sets.size()));
    for (Id i = 0; i < rows.rows(); ++i) {
      const std::vector<Id> row(rows[i].begin(), rows[i].end());
      EXPECT_EQ(row, std::vector<Id>(sets[i].begin(), sets[i].end()));
    }
  };
  same(pc, cells);
  same(pf, faces);
  same(cf, ofCell);
}

TEST(PolyMesh, TopologyCheckNamesWhatIsBroken) {
  const PolyMesh good = block();
  const auto broken = [&](const auto& edit) {
    PolyMesh mesh = good;
    edit(mesh);
    return checkTopology(mesh);
  };
  const auto says = [](const std::string& message, const char* part) {
    return message.find(part) != std::string::npos;
  };
  EXPECT_TRUE(says(broken([](PolyMesh& m) { m.layer.pop_back(); }), "layer"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { m.patch.pop_back(); }), "patch"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { m.faces.values[5] = 100000; }), "does not exist"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { m.faces.values[1] = m.faces.values[0]; }), "twice"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { std::swap(m.owner[0], m.neighbour[0]); }), "not smaller"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { std::swap(m.faces.values[1], m.faces.values[2]); }), "closed"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) {
                     std::reverse(m.faces.values.begin(), m.faces.values.begin() + m.faces.offsets[1]);
                   }),
                   "closed"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) {
                     m.points.emplace_back(0, 0, 0);
                     m.fixed.push_back(0);
                     m.base.push_back(kNone);
                   }),
                   "no face"));
  EXPECT_TRUE(says(broken([](PolyMesh& m) { m.points[3].x() = std::numeric_limits<double>::quiet_NaN(); }),
                   "finite"));
}

TEST(PolyMesh, TopologyCheckFindsABoundaryThatTouchesItself) {
  // Two cubes that share nothing but an edge: each is closed, their boundary is not manifold there.
  const auto cube = [](Id x, Id y) {
    const auto id = [&](Id i, Id j, Id k) { return (x + i) + 3 * (y + j) + 9 * k; };
    return testing::prism({id(0, 0, 0), id(1, 0, 0), id(1, 1, 0), id(0, 1, 0)},
                          {id(0, 0, 1), id(1, 0, 1), id(1, 1, 1), id(0, 1, 1)});
  };
  std::vector<Vec3> points;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) points.emplace_back(i, j, k);
    }
  }
  const auto patch = [](const testing::Face&) { return 0; };
  const PolyMesh touching = testing::joinCells(points, {cube(0, 0), cube(1, 1)}, {"a"}, {"wall"}, patch);
  // Points (2,0) and (0,2) belong to neither cube; drop them so that only the edge is wrong.
  PolyMesh used = touching;
  std::vector<Id> rename(points.size(), kNone);
  used.points.clear();
  for (Id& p : used.faces.values) {
    if (rename[p] == kNone) {
      rename[p] = static_cast<Id>(used.points.size());
      used.points.push_back(points[p]);
    }
    p = rename[p];
  }
  used.fixed.resize(used.points.size());
  used.base.resize(used.points.size(), kNone);
  EXPECT_NE(checkTopology(used).find("manifold"), std::string::npos);
}

TEST(PolyMesh, ChecksumSeesEveryArray) {
  const PolyMesh good = block();
  const auto changed = [&](const auto& edit) {
    PolyMesh mesh = good;
    edit(mesh);
    return checksum(mesh) != checksum(good);
  };
  EXPECT_EQ(checksum(good), checksum(block()));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.points[17].y() += 1e-15; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { std::swap(m.faces.values[0], m.faces.values[1]); }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.owner[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.neighbour[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.patch[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.level[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.layer[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.fixed[3] ^= 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.base[3] += 1; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.patchNames[0] = "other"; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.finestSize *= 2; }));
  EXPECT_TRUE(changed([](PolyMesh& m) { m.stage = Stage::Resolved; }));
}

}  // namespace
}  // namespace pm
