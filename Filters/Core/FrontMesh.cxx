// SPDX-License-Identifier: BSD-3-Clause
#include "FrontMesh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

namespace pm {
namespace {

class FrontMesher {
 public:
  FrontMesher(const Octree& tree, const std::vector<std::uint8_t>& painted, const SurfaceModel& model)
      : tree_(tree), painted_(painted), model_(model) {}

  PolyMesh run() {
    numberCells();
    numberPoints();
    makeFaces();
    namePatches();
    assignPatches();
    mesh_.finestSize = tree_.brick.edge(tree_.brick.maxLevel);
    mesh_.stage = Stage::Front;
    canonicalise(mesh_);
    return std::move(mesh_);
  }

 private:
  /// Faces made by a run of consecutive cells.
  struct Block {
    Csr<Id> internal, boundary;
    std::vector<Id> owner, neighbour;
    std::vector<Id> boundaryOwner;
    std::vector<std::int8_t> side;  // domain side of a boundary face, or -1 for a front face
    std::vector<Id> polygon;
  };
  static constexpr Id kCellsPerBlock = 2048;

  /// Calls body(block, first cell, last cell) for all blocks of cells, in parallel.
  template <class Body>
  void forBlocks(const Body& body) const {
    tbb::parallel_for(Id(0), blockCount(), [&](Id b) {
      body(b, b * kCellsPerBlock, std::min(mesh_.cellCount, (b + 1) * kCellsPerBlock));
    });
  }
  Id blockCount() const { return (mesh_.cellCount + kCellsPerBlock - 1) / kCellsPerBlock; }

  void numberCells() {
    cellOf_.assign(tree_.size(), kNone);
    for (Id leaf = 0; leaf < tree_.size(); ++leaf)
      if (painted_[leaf]) {
        cellOf_[leaf] = static_cast<Id>(leafOf_.size());
        leafOf_.push_back(leaf);
        mesh_.level.push_back(tree_.levels[leaf]);
      }
    mesh_.cellCount = static_cast<Id>(leafOf_.size());
    mesh_.layer.assign(leafOf_.size(), 0);
  }

  /// Corners of the square with lower corner c across `axis`, and of its quarters.
  template <class Add>
  static void lattice(const Coord& c, int axis, std::int32_t half, const Add& add) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int k = 0; k < 9; ++k) {
      Coord p = c;
      p[u] += (k % 3) * half;
      p[v] += (k / 3) * half;
      add(encode(p));
    }
  }

  /// A front face is split in quarters when some, not all, of the four smaller cells across it are painted.
  bool isQuartered(const std::array<Id, 4>& n, int count) const {
    if (count != 4) return false;
    const auto painted = std::count_if(n.begin(), n.end(), [&](Id m) { return painted_[m]; });
    return painted > 0 && painted < 4;
  }

  /// Keys of the corners of cells [first, last) and of the quarters of their front faces, ascending.
  std::vector<Key> nodesOf(Id first, Id last) const {
    std::vector<Key> nodes;
    nodes.reserve(8 * (last - first));
    std::array<Id, 4> n;
    for (Id cell = first; cell < last; ++cell) {
      const Id leaf = leafOf_[cell];
      const std::int32_t span = tree_.brick.span(tree_.levels[leaf]);
      const Coord corner = tree_.corner(leaf);
      for (int k = 0; k < 8; ++k)
        nodes.push_back(encode(
            {corner[0] + (k & 1) * span, corner[1] + (k >> 1 & 1) * span, corner[2] + (k >> 2) * span}));
      for (int side = 0; side < 6; ++side) {
        if (!isQuartered(n, tree_.faceNeighbours(leaf, side, n))) continue;
        Coord c = corner;
        if (side % 2) c[side / 2] += span;
        lattice(c, side / 2, span / 2, [&](Key key) { nodes.push_back(key); });
      }
    }
    sortUnique(nodes);
    return nodes;
  }

  void numberPoints() {
    // Cells of a block share most of their corners, so that little is left to sort after each block's own.
    std::vector<std::vector<Key>> nodesOfBlock(blockCount());
    forBlocks([&](Id b, Id first, Id last) { nodesOfBlock[b] = nodesOf(first, last); });
    for (const auto& nodes : nodesOfBlock) nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    tbb::parallel_sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    nodeIndex_.build(nodes_);
    mesh_.points.resize(nodes_.size());
    mesh_.fixed.assign(nodes_.size(), 0);
    mesh_.base.assign(nodes_.size(), kNone);
    tbb::parallel_for(std::size_t(0), nodes_.size(), [&](std::size_t i) {
      const Coord c = decode(nodes_[i]);
      mesh_.points[i] = tree_.brick.position(c);
      for (int a = 0; a < 3; ++a)
        if (c[a] == 0 || c[a] == tree_.brick.extent(a)) mesh_.fixed[i] |= std::uint8_t(1) << a;
    });
  }

  Id pointAt(const Coord& c) const { return nodeIndex_.find(nodes_, encode(c)); }

  // The square with lower corner c and edge `span` across `axis`, as a polygon with its hanging nodes; its
  // normal points along +axis when `up`.
  void square(Coord c, int axis, std::int32_t span, bool up, std::vector<Id>& polygon) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    polygon.clear();
    constexpr int kTurn[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    for (int k = 0; k < 4; ++k) {
      Coord p = c;
      p[u] += kTurn[k][0] * span;
      p[v] += kTurn[k][1] * span;
      polygon.push_back(pointAt(p));
      if (span == 1) continue;
      Coord middle = c;
      middle[u] += (kTurn[k][0] + kTurn[k + 1][0]) * (span / 2);
      middle[v] += (kTurn[k][1] + kTurn[k + 1][1]) * (span / 2);
      const Id hanging = pointAt(middle);
      if (hanging != kNone) polygon.push_back(hanging);
    }
    if (!up) std::reverse(polygon.begin(), polygon.end());
  }

  void boundaryFace(Block& block, Id leaf, int side, const Coord& corner, std::int32_t span,
                    int domainSide) const {
    square(corner, side / 2, span, side % 2, block.polygon);
    block.boundary.push(block.polygon);
    block.boundaryOwner.push_back(cellOf_[leaf]);
    block.side.push_back(static_cast<std::int8_t>(domainSide));
  }

  void emit(Block& block, Id leaf, int side) const {
    const int axis = side / 2;
    const std::int32_t span = tree_.brick.span(tree_.levels[leaf]);
    Coord corner = tree_.corner(leaf);
    if (side % 2) corner[axis] += span;
    std::array<Id, 4> n;
    const int count = tree_.faceNeighbours(leaf, side, n);
    if (count == 0) return boundaryFace(block, leaf, side, corner, span, side);
    if (count == 1) {
      if (!painted_[n[0]]) return boundaryFace(block, leaf, side, corner, span, -1);
      // The smaller of two cells makes their common face; of equals the first.
      const bool same = tree_.levels[n[0]] == tree_.levels[leaf];
      if (same && n[0] < leaf) return;
      square(corner, axis, span, side % 2, block.polygon);
      block.internal.push(block.polygon);
      block.owner.push_back(cellOf_[leaf]);
      block.neighbour.push_back(cellOf_[n[0]]);
      return;
    }
    if (!isQuartered(n, count)) {
      if (!painted_[n[0]]) boundaryFace(block, leaf, side, corner, span, -1);
      return;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      if (painted_[n[k]]) continue;
      Coord quarter = corner;
      quarter[u] += (k & 1) * (span / 2);
      quarter[v] += (k >> 1) * (span / 2);
      boundaryFace(block, leaf, side, quarter, span / 2, -1);
    }
  }

  void makeFaces() {
    std::vector<Block> blocks(blockCount());
    forBlocks([&](Id b, Id first, Id last) {
      for (Id cell = first; cell < last; ++cell)
        for (int side = 0; side < 6; ++side) emit(blocks[b], leafOf_[cell], side);
    });
    for (const Block& block : blocks) {
      append(block.internal, block.owner);
      mesh_.neighbour.insert(mesh_.neighbour.end(), block.neighbour.begin(), block.neighbour.end());
    }
    for (const Block& block : blocks) {
      append(block.boundary, block.boundaryOwner);
      sides_.insert(sides_.end(), block.side.begin(), block.side.end());
    }
  }

  void append(const Csr<Id>& faces, const std::vector<Id>& owners) {
    const Id first = static_cast<Id>(mesh_.faces.values.size());
    mesh_.faces.values.insert(mesh_.faces.values.end(), faces.values.begin(), faces.values.end());
    for (Id f = 0; f < faces.rows(); ++f) mesh_.faces.offsets.push_back(first + faces.offsets[f + 1]);
    mesh_.owner.insert(mesh_.owner.end(), owners.begin(), owners.end());
  }

  void namePatches() {
    mesh_.patchNames = model_.patchNames();
    mesh_.patchTypes.assign(mesh_.patchNames.size(), "wall");
    firstSide_ = static_cast<Id>(mesh_.patchNames.size());
    const bool sides = tree_.brick.sidesArePatches ||
                       std::any_of(sides_.begin(), sides_.end(), [](int side) { return side >= 0; });
    if (!sides) return;
    for (std::string name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) {
      while (std::count(mesh_.patchNames.begin(), mesh_.patchNames.end(), name)) name += "_domain";
      mesh_.patchNames.push_back(name);
      mesh_.patchTypes.push_back("patch");
    }
  }

  void assignPatches() {
    mesh_.patch.resize(sides_.size());
    tbb::parallel_for(std::size_t(0), sides_.size(), [&](std::size_t i) {
      if (sides_[i] >= 0) {
        mesh_.patch[i] = firstSide_ + sides_[i];
        return;
      }
      Vec3 centre = Vec3::Zero();
      const auto row = mesh_.faces[mesh_.internalFaces() + static_cast<Id>(i)];
      for (Id p : row) centre += mesh_.points[p];
      mesh_.patch[i] = model_.patchOf(model_.closest(centre / double(row.size())).triangle);
    });
  }

  const Octree& tree_;
  const std::vector<std::uint8_t>& painted_;
  const SurfaceModel& model_;
  std::vector<Id> cellOf_, leafOf_;
  std::vector<Key> nodes_;  // sorted keys of the mesh's points
  KeyIndex nodeIndex_;
  std::vector<std::int8_t> sides_;  // of boundary faces: domain side, or -1 for a front face
  Id firstSide_ = 0;
  PolyMesh mesh_;
};

}  // namespace

PolyMesh frontMesh(const Octree& tree, const std::vector<std::uint8_t>& painted, const SurfaceModel& model) {
  return FrontMesher(tree, painted, model).run();
}

}  // namespace pm
