// SPDX-License-Identifier: BSD-3-Clause
// Drifting with local optimisation (thesis 4.4.1, 4.7.2): a wall node goes where it shall whatever breaks,
// and the points around it give way step by step; what does not end valid is put back, to the bit.
#pragma once

#include <functional>
#include <vector>

#include "NodeMover.h"
#include "WallSurface.h"

namespace pm {

class ForcedMove {
 public:
  /// Lets a wall node give way: see mendAlongWall().
  using MendWall = std::function<void(Id row)>;
  /// Moves the node of a row when that betters the worst measure around it, now `badness`; true when kept.
  using Attempt = std::function<bool(const Vec3& to, double badness)>;

  /// wall: the mover's mesh's; must be kept current by its owner.
  ForcedMove(NodeMover& mover, const WallSurface& wall) : mover_(mover), wall_(wall) {}

  /// The points that may move when the node of a row is forced: its column first, then the wall nodes and the
  /// bases beside it, then what lies around its base.
  std::vector<Id> points(Id row) const;
  /// Forces the node of a row, whose points() are given; true when all that moved is kept. Rows without
  /// points in common may be forced in parallel (NodeMover::colourRows).
  bool force(Id row, Span<Id> points, const Vec3& to, const MendWall& mendWall) const;
  /// Asks for places around a wall node, in its tangent plane, until the measures around it are within their
  /// limits.
  void mendAlongWall(Id row, const Attempt& attempt) const;
  /// A place for the lower end of the prism edge from `to`, near where it is, that makes the side faces
  /// around the edge flat: the least sum of squares of distances from their planes.
  Vec3 flatBase(Id row, const Vec3& to) const;
  /// Tries places around a point off the wall, the ideal one first, that make the worst measure there better,
  /// until all are within their limits.
  void mendInner(Id point, const Vec3& ideal, double scale) const;

 private:
  NodeMover& mover_;
  const WallSurface& wall_;
};

}  // namespace pm
