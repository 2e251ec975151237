// SPDX-License-Identifier: BSD-3-Clause
// Cuts and merges of wall faces that are tried before they are made: does the mesh stay valid?
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "FittingCuts.h"
#include "FoamQuality.h"
#include "NodeMover.h"
#include "TestMeshes.h"
#include "TestMoves.h"
#include "TestRandomDomains.h"

namespace {

using namespace pm;
using namespace pm::testing;

/// Every diagonal of every `nth` wall face.
template <class Body>
void forEachDiagonal(const PolyMesh& mesh, Id nth, const Body& body) {
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); f += nth) {
    if (!mesh.isWallPatch(mesh.patch[f - mesh.internalFaces()])) continue;
    const Span<Id> row = mesh.faces[f];
    for (std::size_t i = 0; i + 2 < row.size(); ++i)
      for (std::size_t j = i + 2; j < row.size() && j < i + row.size() - 1; ++j)
        body(WallCut{f, row[i], row[j]});
  }
}

PolyMesh withCut(PolyMesh mesh, const WallCut& cut) {
  cutWallFaces(mesh, {cut});
  return mesh;
}

/// whatIsWrong(), and the limits on OpenFOAM's measures that the mover keeps too.
std::string whatFoamRefuses(const PolyMesh& mesh, const QualityLimits& limits) {
  std::string wrong = whatIsWrong(mesh, limits);
  const MeshMeasures m = measure(mesh);
  const Csr<Id> faces = cellFaces(mesh);
  const double minTet = limits.minTet * std::pow(mesh.finestSize, 3);
  for (Id c = 0; c < mesh.cellCount; ++c) {
    std::vector<Vec3> areas;
    for (Id f : faces[c])
      if (f < mesh.internalFaces()) areas.push_back(m.faces[f].normal);
    if (!(cellDeterminant(areas.data(), areas.size()) >= limits.minDeterminant)) wrong += "A determinant. ";
  }
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const CellMeasures& own = m.cells[mesh.owner[f]];
    const CellMeasures* next = f < mesh.internalFaces() ? &m.cells[mesh.neighbour[f]] : nullptr;
    if (!(faceTetVolume(mesh.points, mesh.faces[f], m.faces[f], own.foamCentre,
                        next ? &next->foamCentre : nullptr, minTet) >= minTet))
      wrong += "A decomposition tetrahedron. ";
    if (next == nullptr) continue;
    if (!(faceWeight(m.faces[f], own.foamCentre, next->foamCentre) >= limits.minFaceWeight))
      wrong += "A weight. ";
    if (!(volumeRatio(own.volume, next->volume) >= limits.minVolumeRatio)) wrong += "A volume ratio. ";
  }
  return wrong;
}

TEST(WallCutTrials, SaysOfACutWhetherTheMeshStaysValid) {
  std::size_t holding = 0, breaking = 0;
  for (unsigned seed = 0; seed < 48; ++seed) {
    PolyMesh mesh = seed % 2 == 0 ? layer(seed) : shaken(seed);
    QualityLimits limits;
    limits.minTet = 1e-5;  // more than the mover's own, so that both judge alike
    if (seed % 4 > 1) limits.maxSkewBoundary = 1.2;
    if (whatFoamRefuses(mesh, limits) != "") continue;
    const NodeMover mover(mesh, limits, pointsNearWall(mesh, 0));
    forEachDiagonal(mesh, 7, [&](const WallCut& cut) {
      const bool holds = mover.cutHolds(cut);
      const std::string wrong = whatFoamRefuses(withCut(mesh, cut), limits);
      EXPECT_EQ(holds, wrong.empty()) << "domain " << seed << ", face " << cut.face << ": " << wrong;
      ++(holds ? holding : breaking);
    });
  }
  EXPECT_GT(holding, 200u);
  EXPECT_GT(breaking, 50u);
}

/// One cut a wall face at most; returns those made.
std::vector<WallCut> cutWhereItHolds(PolyMesh& mesh, const QualityLimits& limits) {
  const NodeMover mover(mesh, limits, pointsNearWall(mesh, 0));
  std::vector<WallCut> cuts;
  forEachDiagonal(mesh, 1, [&](const WallCut& cut) {
    if (mover.cutHolds(cut)) cuts.push_back(cut);
  });
  return cutWallFaces(mesh, cuts);
}

/// Merges what was cut too much, as Resolve Features does; returns how many cuts that undoes.
std::size_t undoWhatBreaks(PolyMesh& mesh, const QualityLimits& limits, const std::vector<WallCut>& cuts) {
  std::size_t undone = 0;
  for (;;) {
    const NodeMover mover(mesh, limits, pointsNearWall(mesh, 1));
    const std::vector<WallMerge> undo = cutsToUndo(mover, cuts);
    if (undo.empty()) return undone;
    const Id before = mesh.faceCount();
    mergeWallFaces(mesh, undo);
    if (mesh.faceCount() == before) throw std::logic_error("nothing was merged");
    undone += before - mesh.faceCount();
  }
}

TEST(WallCutTrials, CutsThatHoldOneByOneHoldTogether) {
  std::size_t made = 0, undone = 0;
  for (unsigned seed = 0; seed < 80; ++seed) {  // in 55 two faces share two points across
    PolyMesh mesh = seed % 2 == 0 ? layer(seed) : shaken(seed);
    const QualitySummary now = summarise(mesh, measure(mesh), {});
    QualityLimits limits;
    limits.minTet = 1e-5;
    if (seed % 4 > 1) limits.maxSkewBoundary = 1.2;
    if (seed % 3 == 0) limits.maxAngleInternal = now.maxAngleInternal * (1 + 1e-6);
    if (seed % 3 == 1) limits.maxAngleBoundary = now.maxAngleBoundary * (1 + 1e-6);
    if (whatFoamRefuses(mesh, limits) != "") continue;
    const std::vector<WallCut> cuts = cutWhereItHolds(mesh, limits);
    made += cuts.size();
    undone += undoWhatBreaks(mesh, limits, cuts);
    EXPECT_EQ(whatFoamRefuses(mesh, limits), "") << "domain " << seed;
  }
  EXPECT_GT(made, 1000u);
  EXPECT_LT(undone, made / 50);  // around cuts that share a cell: each moves its centre
}

TEST(WallCutTrials, CutsThatDoNotHoldAreFoundAndUndone) {
  std::size_t undone = 0, kept = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const PolyMesh whole = shaken(seed);
    QualityLimits limits;
    limits.minTet = 1e-5;
    limits.maxSkewBoundary = 1.2;
    if (whatFoamRefuses(whole, limits) != "") continue;
    PolyMesh mesh = whole;
    std::vector<WallCut> cuts;
    forEachDiagonal(mesh, 12, [&](const WallCut& cut) { cuts.push_back(cut); });
    cuts = cutWallFaces(mesh, cuts);
    const std::size_t without = undoWhatBreaks(mesh, limits, cuts);
    EXPECT_EQ(whatFoamRefuses(mesh, limits), "") << "domain " << seed;
    undone += without;
    kept += cuts.size() - without;
  }
  EXPECT_GT(undone, 10u);
  EXPECT_GT(kept, 5u);
}

TEST(WallCutTrials, SaysOfAMergeWhetherTheMeshStaysValid) {
  std::size_t holding = 0, breaking = 0;
  for (unsigned seed = 0; seed < 48; ++seed) {
    PolyMesh mesh = seed % 2 == 0 ? layer(seed) : shaken(seed);
    QualityLimits limits;
    limits.minTet = 1e-5;
    cutWhereItHolds(mesh, limits);
    // No more than the faces have now: two halves may keep it and the whole not.
    limits.maxWarpage = summarise(mesh, measure(mesh), limits).maxWarpage * (1 + 1e-6);
    if (whatFoamRefuses(mesh, limits) != "") continue;
    const NodeMover mover(mesh, limits, pointsNearWall(mesh, 0));
    for (const WallMerge& merge : wallPairs(mesh)) {
      PolyMesh merged = mesh;
      mergeWallFaces(merged, {merge});
      const std::string wrong = whatFoamRefuses(merged, limits);
      const bool holds = mover.mergeHolds(merge);
      EXPECT_EQ(holds, wrong.empty()) << "domain " << seed << ", face " << merge.first << ": " << wrong;
      ++(holds ? holding : breaking);
    }
  }
  EXPECT_GT(holding, 50u);
  EXPECT_GT(breaking, 5u);
}

TEST(WallCutTrials, CutsAddNoViolationWhereLimitsAreBrokenAlready) {
  QualityLimits strict;
  strict.maxAngleInternal = 35;
  strict.maxSkewInternal = 0.5;
  const auto violations = [&](const PolyMesh& mesh) {
    return summarise(mesh, measure(mesh), strict).violations;
  };
  std::size_t holding = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    PolyMesh mesh = shaken(seed);
    const Id before = violations(mesh);
    ASSERT_GT(before, 0);
    const NodeMover mover(mesh, strict, pointsNearWall(mesh, 0));
    forEachDiagonal(mesh, 1, [&](const WallCut& cut) {
      if (!mover.cutHolds(cut)) return;
      ++holding;
      EXPECT_LE(violations(withCut(mesh, cut)), before) << "domain " << seed << ", face " << cut.face;
    });
  }
  EXPECT_GT(holding, 50u);
}

TEST(WallCutTrials, SaysNoOfCutsAwayFromItsPoints) {
  PolyMesh mesh = layer(5);
  const Id away = mesh.faces[mesh.faceCount() - 1][0];
  const NodeMover mover(mesh, {}, std::vector<Id>{away});
  std::size_t near = 0;
  forEachDiagonal(mesh, 1, [&](const WallCut& cut) {
    const Span<Id> cells = mover.cellsOf(away);
    if (std::find(cells.begin(), cells.end(), mesh.owner[cut.face]) != cells.end())
      ++near;
    else
      EXPECT_FALSE(mover.cutHolds(cut));
  });
  EXPECT_GT(near, 0u);
}

/// What two movers know of a mesh, as far as their callers can see.
void expectSame(const NodeMover& mover, const NodeMover& other) {
  const auto listed = [](Span<Id> ids) { return std::vector<Id>(ids.begin(), ids.end()); };
  for (Id p = 0; p < static_cast<Id>(mover.mesh().points.size()); ++p) {
    ASSERT_EQ(listed(mover.facesOf(p)), listed(other.facesOf(p))) << "point " << p;
    ASSERT_EQ(mover.badness(p), other.badness(p)) << "point " << p;
    for (Id c : mover.cellsOf(p)) ASSERT_EQ(listed(mover.facesOfCell(c)), listed(other.facesOfCell(c)));
  }
}

TEST(WallCutTrials, AMoverKeepsUpWithCutsAndMerges) {
  std::size_t made = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    PolyMesh mesh = seed % 2 == 0 ? layer(seed) : shaken(seed);
    const std::vector<Id> movable = pointsNearWall(mesh, static_cast<int>(seed % 3));
    NodeMover mover(mesh, {}, movable);
    std::vector<WallCut> cuts;
    forEachDiagonal(mesh, 5, [&](const WallCut& cut) { cuts.push_back(cut); });
    std::vector<Id> cells;
    for (const WallCut& cut : cuts) cells.push_back(mesh.owner[cut.face]);
    made += cutWallFaces(mesh, cuts).size();
    mover.wallFacesChanged(cells);
    expectSame(mover, NodeMover(mesh, {}, movable));
    std::vector<WallMerge> merges = wallPairs(mesh);
    cells.clear();
    for (const WallMerge& merge : merges) cells.push_back(mesh.owner[merge.first]);
    mergeWallFaces(mesh, merges);
    mover.wallFacesChanged(cells);
    expectSame(mover, NodeMover(mesh, {}, movable));
  }
  EXPECT_GT(made, 100u);
}

}  // namespace
