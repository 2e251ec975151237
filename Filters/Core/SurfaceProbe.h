// SPDX-License-Identifier: BSD-3-Clause
// Measures of the surface around an octree cell that ask for a cell size: the width of gaps, and curvature.
//
// Gap: from the middle of a triangle's piece in a cell a ray goes along the normal to both sides. The first
// triangle it meets whose plane is turned by less than closeAngle faces the first; w is the length between
// them. A column of cells of edge h along the axis the normal n is nearest to has N free cells, wherever it
// starts, when
//     w >= h (|nx| + |ny| + |nz| + N max |nk|),
// which for walls along the axes is (N + 1) h. Gaps narrower than half the finest cell are none: such sheets
// are one wall drawn twice. Rays walk through the cells of the octree and use their triangle lists.
//
// Curvature: the normals in a cell and its neighbours are fitted by a linear function of the triangles' own
// centres in the tangent plane (a shape operator, by least squares), so that facets larger than cells and
// thrown together triangles give the curvature of what they approximate. Triangles at a sharp angle do not
// count. The cell edge asked for is 2 pi / (N kappa) with the larger principal curvature kappa.
#pragma once

#include <tuple>
#include <vector>

#include "OctreeBuilder.h"
#include "OctreeDecompose.h"

namespace pm {

class SurfaceProbe {
 public:
  SurfaceProbe(const SurfaceModel& model, const Brick& brick, const OctreeDecomposeOptions& options);

  bool measuresGaps() const { return options_.gapCells > 0; }
  bool measuresCurvature() const { return options_.cellsPerCircle > 0; }

  struct Mark {
    Id node, patch;
    bool operator<(const Mark& b) const { return std::tie(node, patch) < std::tie(b.node, b.patch); }
  };
  using Node = OctreeBuilder::Node;
  /// Lists the cells of n's level on rays across a gap that asks for smaller cells, with the asking patch.
  void gap(const OctreeBuilder& builder, const Node& n, Id index, std::vector<Mark>& marks) const;
  /// Is the cell too large for the curvature of the surface there?
  bool bends(const OctreeBuilder& builder, const Node& n) const;

 private:
  double rayLength(const OctreeBuilder& builder, const Vec3& from, const Vec3& along, double most,
                   double step, int level, Id own) const;
  void markRay(const OctreeBuilder& builder, const Vec3& from, const Vec3& along, double length,
               const Node& n, Id patch, std::vector<Mark>& marks) const;
  Id nodeAt(const OctreeBuilder& builder, const Vec3& p, int level) const;

  const SurfaceModel& model_;
  const OctreeDecomposeOptions& options_;
  const Brick brick_;
  const double finest_, cosFacing_, cosSharp_;
};

}  // namespace pm
