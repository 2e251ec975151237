// SPDX-License-Identifier: BSD-3-Clause
// Small painted octrees thrown together at random, for property tests of the front and of the layer on it.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "MeshQuality.h"
#include "PaintFront.h"
#include "TestSurfaces.h"

namespace pm::testing {

struct RandomDomain {
  std::unique_ptr<SurfaceModel> model;  ///< a few triangles, so that some cells do not see each other
  Octree tree;                          ///< balanced, at most eight finest cells along an axis
  std::vector<std::uint8_t> painted;  ///< #L noise, boxes, walks one cell thick, balls, or the rest of these
};

/// The same domain for the same seed. stretch: cells may be that many times longer along one axis than along
/// another.
RandomDomain randomDomain(unsigned seed, double stretch = 1);

struct RepairedFront {
  std::vector<std::uint8_t> painted;
  PaintFrontReport report;
  PolyMesh mesh;  ///< empty when repair left no cell
};
/// Filling, repair and the front's mesh, as paintFront() does them.
RepairedFront repairedFront(const RandomDomain& domain, bool fill);

/// The octants around every front node strictly inside the brick.
std::vector<unsigned> frontPatterns(const Octree& tree, const std::vector<std::uint8_t>& painted);

/// Empty when mesh is topologically right and every measure, taken afresh, is within the limits.
std::string whatIsWrong(const PolyMesh& mesh, const QualityLimits& limits = {});

}  // namespace pm::testing
