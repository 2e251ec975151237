// SPDX-License-Identifier: BSD-3-Clause
// Layers divide faces of cells beside prisms, too, which moves those cells' centres: the angles at layers are
// within the limit all the same, wherever the limit is.
#include <gtest/gtest.h>

#include <algorithm>

#include "BoundaryRefine.h"
#include "TestMoves.h"

namespace {

using namespace pm;
using namespace pm::testing;

TEST(LayerLimits, HoldForCellsBesideLayers) {
  int layered = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    PolyMesh mesh = shaken(seed);
    for (Id c = 0; c < mesh.cellCount; c += 4) mesh.layer[c] = 0;  // without the mark it stays whole
    for (double limit = 25; limit < 65; limit += 8) {
      BoundaryRefineOptions options;
      options.limits.maxAngleInternal = limit;
      Monitor monitor;
      const PolyMesh refined = boundaryRefine(mesh, options, monitor);
      const MeshMeasures m = measure(refined);
      for (Id f = 0; f < refined.internalFaces(); ++f) {
        // Of two layers at least; one alone is the prism that was there.
        if (std::max(refined.layer[refined.owner[f]], refined.layer[refined.neighbour[f]]) < 2) continue;
        ++layered;
        EXPECT_LE(m.faceAngle[f], limit + 1e-4) << "domain " << seed << ", face " << f;
      }
    }
  }
  EXPECT_GT(layered, 500);
}

}  // namespace
