// SPDX-License-Identifier: BSD-3-Clause
// Octrees for the tests of what refines them.
#pragma once

#include <gtest/gtest.h>

#include "OctreeDecompose.h"
#include "TestSurfaces.h"

namespace pm::testing {

/// Nothing asks but what a test turns on.
inline OctreeDecomposeOptions bare(double featureSize) {
  OctreeDecomposeOptions o;
  o.featureSize = featureSize;
  o.normalAngle = 0;
  o.separate = o.refineEdges = false;
  o.bufferCells = 0;
  o.featureDepth = FeatureDepth::Full;
  return o;
}

inline Octree run(const SurfaceModel& model, const OctreeDecomposeOptions& o) {
  Monitor monitor;
  Octree tree = decompose(model, o, monitor);
  EXPECT_TRUE(isComplete(tree));
  EXPECT_TRUE(isBalanced(tree));
  return tree;
}

inline double edgeAt(const Octree& tree, const Vec3& p) {
  return tree.brick.edge(tree.levels[tree.locate(p)]);
}

inline bool finestAt(const Octree& tree, const Vec3& p) {
  return tree.levels[tree.locate(p)] == tree.brick.maxLevel;
}

}  // namespace pm::testing
