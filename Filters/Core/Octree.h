// SPDX-License-Identifier: BSD-3-Clause
// A linear octree over a brick of root cells: leaves as sorted Morton keys with levels, no pointers.
//
// A key is the Morton code of the leaf's lower corner on the finest grid (21 bits an axis). Root cells may
// differ in edge length between axes by the little that makes a box domain end exactly on cell faces.
#pragma once

#include <array>
#include <vector>

#include "KeyIndex.h"
#include "Types.h"

namespace pm {

class SurfaceModel;

using Coord = std::array<std::int32_t, 3>;  ///< position on the finest grid

constexpr int kMaxLevel = 18;
constexpr int kCoordBits = 21;

Key encode(const Coord& c);
Coord decode(Key key);

/// Where the octree lies in space.
struct Brick {
  Vec3 origin = Vec3::Zero();
  Vec3 rootSize = Vec3::Ones();
  std::array<std::int32_t, 3> roots{1, 1, 1};  ///< root cells along each axis
  int maxLevel = 0;                            ///< level of the finest grid
  bool sidesArePatches = false;                ///< a given box domain: its sides bound the mesh

  std::int32_t span(int level) const {
    return std::int32_t(1) << (maxLevel - level);
  }  ///< edge in finest cells
  std::int32_t extent(int axis) const { return roots[axis] << maxLevel; }
  Vec3 cellSize(int level) const { return rootSize / double(std::int64_t(1) << level); }
  double edge(int level) const { return cellSize(level).maxCoeff(); }
  /// Exact on the far side of the brick, so that domain sides are flat to the bit.
  Vec3 position(const Coord& c) const;
  Box box(Key key, int level) const;
  bool inside(const Coord& c) const;
};

/// How far (length) a triangle may be from a cell of the level that it counts as touching: a billionth of the
/// cell's edge, or what rounding of coordinates far from the origin takes.
double touchSlack(const Brick& brick, int level);

class Octree {
 public:
  Brick brick;
  std::vector<Key> keys;             // #L ascending
  std::vector<std::uint8_t> levels;  // #L
  Csr<Id> triangles;  // #L rows: triangles that touch the leaf; empty lists after load from a file
  std::vector<std::uint8_t> cut;             // #L 1 = a triangle touches the leaf
  std::vector<std::uint8_t> refinedBy;       // #L RefineReason that split the leaf's parent; empty after load
  std::vector<std::int16_t> refinedByPatch;  // #L patch of the triangle that asked, kNone for none; likewise

  Id size() const { return static_cast<Id>(keys.size()); }
  Coord corner(Id leaf) const { return decode(keys[leaf]); }
  Box box(Id leaf) const { return brick.box(keys[leaf], levels[leaf]); }
  /// Builds the lookup behind find(); call after keys changed.
  void index();
  /// Leaf that covers the finest cell c, kNone outside the brick.
  Id find(const Coord& c) const;
  /// The same for the finest cell of a key, which must lie in the brick.
  Id covering(Key key) const;
  /// Leaf that holds a point, kNone outside the brick.
  Id locate(const Vec3& p) const;
  /// Leaves across side s (2*axis + (0 lower, 1 upper)): none, one, or up to four smaller ones.
  int faceNeighbours(Id leaf, int side, std::array<Id, 4>& out) const;

 private:
  KeyIndex index_;
};

/// Predicates: leaves tile the brick without hole or overlap; adjacent leaves (face, edge, corner) differ by
/// <= 1 level.
bool isComplete(const Octree& tree);
bool isBalanced(const Octree& tree);
/// Lists are sound: each holds every triangle that touches its leaf, none that misses it by more than
/// rounding asks for, in ascending order, and `cut` tells which are not empty. Tests leaves against the
/// model's own search, not against how the lists were made.
bool findsAllTriangles(const Octree& tree, const SurfaceModel& model);

}  // namespace pm
