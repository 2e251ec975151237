// SPDX-License-Identifier: BSD-3-Clause
// The prismatic layer on the front: one prism a front face, valid, nothing else changed.
#include <gtest/gtest.h>

#include <algorithm>

#include "DummyLayer.h"
#include "NodeMover.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "TestSurfaces.h"

namespace {

using namespace pm;
using namespace pm::testing;

PolyMesh front(const SurfaceModel& model, double size, bool outside) {
  Monitor monitor;
  OctreeDecomposeOptions o;
  o.featureSize = size;
  PaintFrontOptions p;
  if (outside) {
    o.useDomain = true;
    o.domain.add(model.bounds().lo - Vec3(1, 1, 0.5));
    o.domain.add(model.bounds().hi + Vec3(1, 1, 1));
    p.region = Region::Outside;
  }
  return paintFront(decompose(model, o, monitor), model, p, monitor);
}

Id wallFaces(const PolyMesh& mesh) {
  return static_cast<Id>(
      std::count_if(mesh.patch.begin(), mesh.patch.end(), [&](Id p) { return mesh.isWallPatch(p); }));
}

TEST(DummyLayer, OnePrismOnEachFrontFaceAndValid) {
  for (bool outside : {false, true}) {
    const auto model = cylinder(48).model();
    const PolyMesh before = front(*model, 0.12, outside);
    Monitor monitor;
    const PolyMesh after = dummyLayer(before, {}, monitor);
    EXPECT_EQ(checkTopology(after), "");
    EXPECT_EQ(after.cellCount, before.cellCount + wallFaces(before));
    EXPECT_EQ(wallFaces(after), wallFaces(before));
    EXPECT_EQ(std::count(after.layer.begin(), after.layer.end(), 1), wallFaces(before));
    const MeshMeasures m = measure(after);
    EXPECT_EQ(summarise(after, m, {}).violations, 0) << describeViolations(after, m, {});
    EXPECT_EQ(after.stage, Stage::Layer);
  }
}

TEST(DummyLayer, SaysWhichLimitsNoPrismCanKeep) {
  struct Listener : Monitor {
    void warning(const std::string& sentence) override { warnings.push_back(sentence); }
    std::vector<std::string> warnings;
  } listener;
  const PolyMesh before = front(*cylinder(48).model(), 0.12, false);
  dummyLayer(before, {}, listener);
  EXPECT_TRUE(listener.warnings.empty());
  DummyLayerOptions o;
  o.limits.maxAngleBoundary = 5;  // on a staircase
  EXPECT_EQ(dummyLayer(before, o, listener).cellCount, before.cellCount + wallFaces(before));
  ASSERT_EQ(listener.warnings.size(), 1u);
  EXPECT_NE(listener.warnings[0].find("Widen the limits"), std::string::npos) << listener.warnings[0];
}

TEST(DummyLayer, StaysOnTheDomainSides) {
  // The cylinder stands through the floor of the domain, so its front ends there.
  const auto model = cylinder(32).model();
  Monitor monitor;
  OctreeDecomposeOptions o;
  o.featureSize = 0.15;
  o.useDomain = true;
  o.domain.add(Vec3(-3, -3, 0.5));
  o.domain.add(Vec3(3, 3, 4));
  PaintFrontOptions p;
  p.region = Region::Outside;
  const PolyMesh mesh =
      dummyLayer(paintFront(decompose(*model, o, monitor), *model, p, monitor), {}, monitor);
  EXPECT_EQ(checkTopology(mesh), "");
  int onFloor = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (mesh.base[i] != kNone && (mesh.fixed[i] & 4)) {
      ++onFloor;
      EXPECT_EQ(mesh.points[i][2], 0.5);
    }
  EXPECT_GT(onFloor, 0);
}

TEST(DummyLayer, RefusesAThicknessThatCannotBeValid) {
  const auto model = cube().model();
  const PolyMesh before = front(*model, 0.1, false);
  Monitor monitor;
  DummyLayerOptions o;
  o.thickness = 0;
  EXPECT_THROW(dummyLayer(before, o, monitor), InputError);
}

TEST(NodeMover, StormsOfRandomMovesNeverBreakALimitAndUndoIsExact) {
  const auto model = cylinder(40).model();
  Monitor monitor;
  PolyMesh mesh = dummyLayer(front(*model, 0.15, false), {}, monitor);
  NodeMover mover(mesh, {});
  std::mt19937_64 g(11);
  int kept = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const Id p = static_cast<Id>(g() % mesh.points.size());
    const Vec3 before = mesh.points[p];
    const Vec3 target = before + 0.2 * randomPoint(g, -1, 1);
    if (mover.move(p, target)) {
      ++kept;
      EXPECT_EQ(mesh.points[p], target);
    } else {
      ++refused;
      EXPECT_EQ(mesh.points[p], before);
    }
  }
  EXPECT_GT(kept, 1000);
  EXPECT_GT(refused, 1000);
  const MeshMeasures m = measure(mesh);
  EXPECT_EQ(summarise(mesh, m, {}).violations, 0) << describeViolations(mesh, m, {});
  // Caches after the storm equal a fresh mover's: nothing was left behind by undone moves.
  const NodeMover fresh(mesh, {});
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    EXPECT_EQ(mover.faceCentre(f), fresh.faceCentre(f));
    EXPECT_EQ(mover.faceNormal(f), fresh.faceNormal(f));
  }
  for (Id c = 0; c < mesh.cellCount; ++c) EXPECT_EQ(mover.cellCentre(c), fresh.cellCentre(c));
}

TEST(NodeMover, PointsOfAColourTouchNothingInCommon) {
  const auto model = cube().model();
  Monitor monitor;
  PolyMesh mesh = dummyLayer(front(*model, 0.12, false), {}, monitor);
  const NodeMover mover(mesh, {});
  std::vector<Id> all(mesh.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Id>(i);
  const auto groups = mover.colour(all);
  const Csr<Id> faces = cellFaces(mesh);
  std::size_t count = 0;
  for (const auto& group : groups) {
    count += group.size();
    std::vector<Id> writer(mesh.cellCount, kNone);
    for (Id p : group)
      for (Id c : mover.cellsOf(p)) writer[c] = p;
    for (Id p : group)
      for (Id c : mover.cellsOf(p))
        for (Id f : faces[c]) {
          const Id other =
              mesh.owner[f] == c ? (f < mesh.internalFaces() ? mesh.neighbour[f] : c) : mesh.owner[f];
          EXPECT_TRUE(writer[other] == kNone || writer[other] == p);
        }
  }
  EXPECT_EQ(count, all.size());
}

TEST(NodeMover, WhatFailedFailsAgainUntilSomethingAroundItMoves) {
  const auto model = cylinder(40).model();
  Monitor monitor;
  PolyMesh mesh = dummyLayer(front(*model, 0.15, false), {}, monitor);
  NodeMover mover(mesh, {});
  std::vector<Vec3> targets = mesh.points;
  for (Vec3& t : targets) t += Vec3(0.08, 0.06, -0.04);
  std::vector<Id> all(mesh.points.size()), failedAt(mesh.points.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Id>(i);
  const auto groups = mover.colour(all);
  const auto sweep = [&] {
    mover.forEach(groups, [&](Id p) { failedAt[p] = mover.move(p, targets[p]) ? 0 : mover.tick(); });
  };
  const auto isStirred = [&](Id p) { return failedAt[p] > 0 && mover.lastChange(p) >= failedAt[p]; };
  sweep();
  EXPECT_GT(std::count_if(all.begin(), all.end(), isStirred), 0);
  for (int k = 0; k < 4; ++k) sweep();
  int still = 0;
  for (Id p : all) {
    if (failedAt[p] == 0 || isStirred(p)) continue;
    ++still;
    EXPECT_FALSE(mover.move(p, targets[p]));
  }
  EXPECT_GT(still, 0);
}

TEST(NodeMover, ARefusedMoveIsSeenInPlaceAndUndone) {
  const auto model = cylinder(40).model();
  Monitor monitor;
  PolyMesh mesh = dummyLayer(front(*model, 0.15, false), {}, monitor);
  NodeMover mover(mesh, {});
  int asked = 0;
  for (Id p = 0; p < static_cast<Id>(mesh.points.size()); ++p) {
    const Vec3 from = mesh.points[p], to = from + Vec3(0.01, 0, 0);
    const Id f = mover.facesOf(p)[0];
    const Vec3 centre = mover.faceCentre(f);
    EXPECT_FALSE(mover.moveIf(p, to, [&] {
      ++asked;
      EXPECT_EQ(mover.point(p), to);
      EXPECT_EQ(mover.faceCentre(f), measureFace(mesh.points, mesh.faces[f]).centre);
      return false;
    }));
    EXPECT_EQ(mover.point(p), from);
    EXPECT_EQ(mover.faceCentre(f), centre);
  }
  EXPECT_GT(asked, 1000);
}

}  // namespace
