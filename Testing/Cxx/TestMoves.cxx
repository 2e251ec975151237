// SPDX-License-Identifier: BSD-3-Clause
#include "TestMoves.h"

#include <random>

#include "DummyLayer.h"
#include "TestMeshes.h"
#include "TestRandomDomains.h"

namespace pm::testing {

PolyMesh layer(unsigned seed) {
  Monitor monitor;
  for (;; seed += 1000) {
    PolyMesh front = repairedFront(randomDomain(seed, 1), false).mesh;
    if (front.cellCount > 50) return dummyLayer(std::move(front), {}, monitor);
  }
}

std::vector<Id> allPoints(const PolyMesh& mesh) {
  std::vector<Id> all(mesh.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Id>(i);
  return all;
}

void randomMove(NodeMover& mover, const PolyMesh& mesh, Id p, unsigned seed, unsigned kind) {
  std::mt19937_64 g(seed);
  const Vec3 d = 0.3 * mesh.finestSize * randomPoint(g, -1, 1);
  const Id base = mesh.base[p];
  if (base != kNone && kind == 0)
    mover.moveTogether({p, base}, {mesh.points[p] + d, mesh.points[base] + 0.5 * d});
  else if (kind == 1)
    mover.improve(p, mesh.points[p] + d);
  else
    mover.drift(p, mesh.points[p] + d);
}

void sweep(NodeMover& mover, const PolyMesh& mesh, const MoveBlocks& blocks) {
  for (unsigned round = 0; round < 4; ++round)
    mover.forEach(
        blocks, [&](Id p) { randomMove(mover, mesh, p, 31 * static_cast<unsigned>(p) + round, round % 2); });
}

PolyMesh shaken(unsigned seed) {
  PolyMesh mesh = layer(seed);
  NodeMover mover(mesh, {});
  for (int k = 0; k < 3; ++k) sweep(mover, mesh, mover.blocks(allPoints(mesh)));
  return mesh;
}

}  // namespace pm::testing
