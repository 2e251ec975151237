// SPDX-License-Identifier: BSD-3-Clause
// Which octree cells the geometry asks to split: criteria 1-5, 7 and 9 of thesis 3.4.4, the sizes a user
// gives, gaps and curvature.
//
// Every criterion looks at one cell, or at two adjacent cells of one level, and at the triangles in them as
// they come: no connectivity, no orientation. A cell is judged by an even sample of its triangles. All
// answers of a level are found in parallel and depend on nothing but the level before.
#pragma once

#include <array>
#include <vector>

#include "FeatureDepth.h"
#include "OctreeBuilder.h"
#include "OctreeDecompose.h"
#include "RefineReason.h"
#include "SizeField.h"
#include "SurfaceProbe.h"

namespace pm {

class RefinementCriteria {
 public:
  RefinementCriteria(const SurfaceModel& model, const Brick& brick, const OctreeDecomposeOptions& options,
                     Monitor& monitor);

  struct Choice {
    std::vector<Id> leaves;           ///< to be split, ascending
    std::vector<RefineCause> causes;  ///< one for each
  };
  /// The leaves of the batch (consecutive nodes, all of one level below the finest) that should be split.
  Choice select(const OctreeBuilder& builder, const std::vector<Id>& batch) const;

 private:
  using Node = OctreeBuilder::Node;

  /// What the surface is like inside one cut cell that is not split for what is in it.
  struct Summary {
    static constexpr int kSample = 8;
    Vec3 normal = Vec3::Zero();      ///< mean of the normals, signs aligned
    Vec3 centre = Vec3::Zero();      ///< mean of the cut figures' centres
    std::array<Id, kSample> sample;  ///< an even sample of the triangles
    int samples = 0;
  };
  /// The smooth pieces of surface in a cell that holds a feature it need not be split for.
  struct Sides {
    static constexpr int kMost = 4;
    std::array<Eigen::Vector3f, kMost> normal, centre;  ///< centres relative to the brick's origin
    std::uint8_t count = 0;                             ///< 0 = the cell is not known to hold a feature
    bool feature = false;
  };
  /// One level's answers; rows are cut cells.
  struct Level {
    const OctreeBuilder& builder;
    const std::vector<Id>& batch;
    std::vector<RefineCause> cause;  // of each cell, Root = none yet
    std::vector<Id> row;             // of each cell, kNone where it is not cut
    std::vector<Summary> summary;
    std::vector<Sides> sides;  // empty at full depth
    Id place(Id node) const { return node - batch.front(); }
  };
  struct Sample;

  RefineCause sizeAsksFor(const OctreeBuilder& builder, const Node& n) const;
  RefineCause look(const OctreeBuilder& builder, const Node& n, Summary& s, Sides* sides) const;
  RefineCause besideFeature(const Box& cell) const;
  RefineCause lookAtSurface(const Sample& sample, const Box& cell, Summary& s) const;
  RefineCause lookAtSides(const Sample& sample, const Box& cell, int most, Sides& sides) const;
  bool facing(const Sample& sample, std::size_t i, std::size_t j, const Box& cell) const;
  bool facing(const Vec3& normalA, const Vec3& normalB, const Vec3& between) const;
  bool opposite(const Vec3& from, const Vec3& normal, Id triangle, const Box& cell) const;
  RefineReason disagree(const Level& level, std::size_t a, std::size_t b) const;
  RefineReason sidesDisagree(const Level& level, std::size_t a, std::size_t b) const;
  bool featureBetween(const Level& level, std::size_t a, std::size_t b) const;
  void compareNeighbours(Level& level) const;
  void probe(Level& level) const;
  static void fillIslands(Level& level);
  void evenCurves(Level& level) const;
  Id patchIn(const OctreeBuilder& builder, const Node& n) const {
    return model_.patchOf(builder.triangles(n)[0]);
  }
  RefineCause because(RefineReason reason, Id triangle) const {
    return {reason, 0, narrowPatch(model_.patchOf(triangle))};
  }

  const SurfaceModel& model_;
  const OctreeDecomposeOptions& options_;
  const Brick brick_;
  FeatureDemand features_;
  SizeField sizes_;
  SurfaceProbe probe_;
  std::vector<double> patchSize_;  // by patch id, 0 = none
  double finest_;
  double cosNormal_, cosHalfNormal_, sinClose_, cosClose_, cosSide_;
};

}  // namespace pm
