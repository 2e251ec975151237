// SPDX-License-Identifier: BSD-3-Clause
// Which octree cells the geometry asks to split: criteria 1-5 and 9 of thesis 3.4.4.
#pragma once

#include <array>
#include <vector>

#include "FeatureEdges.h"
#include "OctreeBuilder.h"
#include "OctreeDecompose.h"

namespace pm {

class RefinementCriteria {
 public:
  RefinementCriteria(const SurfaceModel& model, const Brick& brick, const OctreeDecomposeOptions& options);

  /// The leaves of the batch (all of one level, below the finest) that should be split, ascending. Parallel.
  std::vector<Id> select(const OctreeBuilder& builder, const std::vector<Id>& batch) const;

 private:
  /// What the surface is like inside one cell.
  struct Summary {
    static constexpr int kNormals = 8;
    Vec3 normal = Vec3::Zero();          ///< mean of the normals, signs aligned
    Vec3 centre = Vec3::Zero();          ///< mean of the cut figures' centres
    std::array<Vec3, kNormals> normals;  ///< an even sample of the normals
    int normalCount = 0;
    bool split = false, cut = false;
  };
  bool sizeAsksFor(const OctreeBuilder& builder, const OctreeBuilder::Node& n) const;
  bool featureInside(Box box) const;
  Summary look(const OctreeBuilder& builder, const OctreeBuilder::Node& n) const;
  bool facing(const Vec3& normalA, const Vec3& normalB, const Vec3& between) const;
  bool disagree(const Summary& a, const Summary& b) const;
  static void fillIslands(const OctreeBuilder& builder, const std::vector<Id>& batch,
                          std::vector<std::uint8_t>& split);

  const SurfaceModel& model_;
  const OctreeDecomposeOptions& options_;
  FeatureGraph features_;
  std::vector<double> patchSize_;  // by patch id, 0 = none
  double finest_;
  double cosNormal_, cosHalfNormal_, sinClose_;
};

}  // namespace pm
