// SPDX-License-Identifier: BSD-3-Clause
// Where the points between layers lie on the prism edges.
//
// They need not lie on the straight line from the wall to the lower point: where that is not valid, the edge
// takes another course. It may leave the wall in the direction that sees all wall faces and bend to its lower
// end, its layers may be a fraction as high, or it may be pinched: its layers taper to nothing at the wall
// point. Courses are numbered; 0 is the straight one. On any but the pinched an edge may lean to a side.
#pragma once

#include "LayerColumns.h"
#include "WallSight.h"

namespace pm {

/// Heights of the layers on one edge, measured along it.
struct EdgeHeights {
  double first = 0;      ///< of the layer at the wall
  double expansion = 1;  ///< of a layer over that before it
  double share = 0;      ///< length of the edge of which first is a share; 0 when it does not depend on it
  /// From the wall to the end of `layers` layers.
  double sum(Id layers) const;
};

class LayerPoints {
 public:
  static constexpr int kCourses = 10, kPinched = kCourses - 1;
  static constexpr int kFullCourses = 2;  ///< the first ones, with layers as high as wanted

  /// heights: #P by lower point. Numbers the points of the columns' edges behind the mesh's own and places
  /// them straight; an edge that sees hardly anything of its wall is pinched. All arguments must outlive
  /// this.
  LayerPoints(const PolyMesh& mesh, LayerColumns& columns, const WallSight& sight,
              const std::vector<EdgeHeights>& heights);

  /// The mesh's points and behind them those on the edges.
  const std::vector<Vec3>& all() const { return all_; }
  int course(Id lower) const { return course_[lower]; }
  /// False when the edge cannot take it: one of several edges that end in one wall point stays as it is.
  bool setCourse(Id lower, int course);
  /// How far the edge leaves its course to a side, over its length: the direction in which it leaves the
  /// wall changes by this, and less and less towards its lower end.
  const Vec3& lean(Id lower) const { return lean_[lower]; }
  void setLean(Id lower, const Vec3& lean);  ///< as far as it keeps to domain sides
  /// Puts the points of an edge anew after its lower point was moved.
  void follow(Id lower);

 private:
  const PolyMesh& mesh_;
  LayerColumns& columns_;
  const WallSight& sight_;
  const std::vector<EdgeHeights>& heights_;
  std::vector<Vec3> all_;
  std::vector<std::uint8_t> course_;  // #P
  std::vector<Vec3> lean_;            // #P
  std::vector<std::uint8_t> single_;  // #P whether a wall point has one prism edge
};

}  // namespace pm
