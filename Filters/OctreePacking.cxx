// SPDX-License-Identifier: BSD-3-Clause
#include "OctreePacking.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>

#include "GridArrays.h"
#include "RefineReason.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt16Array.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace pm {

namespace {

constexpr int kCorners = 8;

/// Corner 0..7 of a leaf in VTK_VOXEL's order: x fastest.
Coord cornerOf(const Octree& tree, Id leaf, int corner) {
  const Coord low = tree.corner(leaf);
  const std::int32_t span = tree.brick.span(tree.levels[leaf]);
  return {low[0] + (corner & 1 ? span : 0), low[1] + (corner & 2 ? span : 0),
          low[2] + (corner & 4 ? span : 0)};
}

/// A corner that is no leaf's lower corner: it hangs on a larger leaf or lies on a far side of the brick.
struct LooseCorner {
  Coord position;
  vtkIdType slot;
  bool operator<(const LooseCorner& b) const {
    return position != b.position ? position < b.position : slot < b.slot;
  }
};

/// Point of each leaf corner: leaf i's lower corner is point i, the loose corners follow in order of
/// position. positions gets the coordinates of the loose ones.
vtkSmartPointer<vtkTypeInt64Array> numberCorners(const Octree& tree, std::vector<Coord>& positions) {
  const Id leaves = tree.size();
  auto connectivity = vtkSmartPointer<vtkTypeInt64Array>::New();
  connectivity->SetNumberOfValues(kCorners * vtkIdType(leaves));
  vtkTypeInt64* ids = connectivity->GetPointer(0);
  std::vector<Id> start(leaves + 1, 0);
  tbb::parallel_for(Id(0), leaves, [&](Id leaf) {
    for (int corner = 0; corner < kCorners; ++corner) {
      const Coord c = cornerOf(tree, leaf, corner);
      const Id holder = corner == 0 ? leaf : tree.find(c);
      const bool lower = holder != kNone && tree.corner(holder) == c;
      ids[kCorners * vtkIdType(leaf) + corner] = lower ? holder : kNone;
      start[leaf] += !lower;
    }
  });
  std::exclusive_scan(start.begin(), start.end(), start.begin(), Id(0));
  std::vector<LooseCorner> loose(start[leaves]);
  tbb::parallel_for(Id(0), leaves, [&](Id leaf) {
    Id next = start[leaf];
    for (int corner = 0; corner < kCorners; ++corner) {
      const vtkIdType slot = kCorners * vtkIdType(leaf) + corner;
      if (ids[slot] == kNone) loose[next++] = {cornerOf(tree, leaf, corner), slot};
    }
  });
  tbb::parallel_sort(loose.begin(), loose.end());
  for (const LooseCorner& corner : loose) {
    if (positions.empty() || positions.back() != corner.position) positions.push_back(corner.position);
    ids[corner.slot] = leaves + static_cast<vtkIdType>(positions.size()) - 1;
  }
  return connectivity;
}

void setVoxels(const Octree& tree, vtkUnstructuredGrid* grid) {
  const Id leaves = tree.size();
  std::vector<Coord> loose;
  const auto connectivity = numberCorners(tree, loose);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(vtkIdType(leaves) + static_cast<vtkIdType>(loose.size()));
  auto* xyz = static_cast<double*>(points->GetVoidPointer(0));
  tbb::parallel_for(vtkIdType(0), points->GetNumberOfPoints(), [&](vtkIdType p) {
    const Vec3 x = tree.brick.position(p < leaves ? tree.corner(static_cast<Id>(p)) : loose[p - leaves]);
    std::copy_n(x.data(), 3, xyz + 3 * p);
  });
  grid->SetPoints(points);
  vtkNew<vtkTypeInt64Array> offsets;
  offsets->SetNumberOfValues(leaves + 1);
  for (vtkIdType i = 0; i <= leaves; ++i) offsets->SetValue(i, kCorners * i);
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);
  grid->SetCells(VTK_VOXEL, cells);
}

std::uint64_t mix(std::uint64_t h, std::uint64_t value) {
  h ^= value + 0x9e3779b97f4a7c15ull + (h << 6) + (h >> 2);
  return h * 0xff51afd7ed558ccdull;
}

std::uint64_t octreeChecksum(const Octree& tree) {
  std::uint64_t h = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (double value : {tree.brick.origin[axis], tree.brick.rootSize[axis]}) {
      std::uint64_t bits;
      std::copy_n(reinterpret_cast<const char*>(&value), sizeof bits, reinterpret_cast<char*>(&bits));
      h = mix(h, bits);
    }
    h = mix(h, static_cast<std::uint64_t>(tree.brick.roots[axis]));
  }
  h = mix(h, static_cast<std::uint64_t>(tree.brick.maxLevel) * 2 + tree.brick.sidesArePatches);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    h = mix(h, tree.keys[leaf]);
    h = mix(h, tree.levels[leaf] * 2u + (tree.cut[leaf] != 0));
  }
  return h;
}

void packReasons(const Octree& tree, vtkUnstructuredGrid* grid) {
  if (tree.refinedBy.empty()) return;
  addArray<vtkUnsignedCharArray>(grid->GetCellData(), "RefinedBy", tree.refinedBy);
  addArray<vtkTypeInt16Array>(grid->GetCellData(), "RefinedByPatch", tree.refinedByPatch);
  addStrings(grid->GetFieldData(), "RefinedByNames", {kRefineReasonNames.begin(), kRefineReasonNames.end()});
}

std::vector<double> toVector(const Vec3& v) { return {v[0], v[1], v[2]}; }

}  // namespace

void packOctree(const Octree& tree, vtkUnstructuredGrid* grid) {
  grid->Initialize();
  setVoxels(tree, grid);
  addArray<vtkUnsignedCharArray>(grid->GetCellData(), "Level", tree.levels);
  addArray<vtkUnsignedCharArray>(grid->GetCellData(), "Cut", tree.cut);
  addArray<vtkTypeInt64Array>(grid->GetCellData(), "Key", tree.keys);
  vtkFieldData* field = grid->GetFieldData();
  packReasons(tree, grid);
  const Brick& brick = tree.brick;
  addArray<vtkDoubleArray>(field, "BrickOrigin", toVector(brick.origin));
  addArray<vtkDoubleArray>(field, "BrickRootSize", toVector(brick.rootSize));
  addArray<vtkTypeInt32Array>(field, "BrickRoots", std::vector<Id>(brick.roots.begin(), brick.roots.end()));
  addArray<vtkTypeInt32Array>(field, "BrickMaxLevel", std::vector<Id>{brick.maxLevel});
  addArray<vtkTypeInt32Array>(field, "BrickSidesArePatches", std::vector<Id>{brick.sidesArePatches});
  addStamp(grid, Stage::Octree, 0, octreeChecksum(tree));
}

Octree unpackOctree(vtkUnstructuredGrid* grid, const std::string& filter) {
  const Stamp stamp = readStamp(grid, filter, {Stage::Octree});
  vtkFieldData* field = grid->GetFieldData();
  const auto origin = readArray<double>(field, "BrickOrigin", 3, filter);
  const auto rootSize = readArray<double>(field, "BrickRootSize", 3, filter);
  const auto roots = readArray<Id>(field, "BrickRoots", 3, filter);
  Octree tree;
  tree.brick.origin = {origin[0], origin[1], origin[2]};
  tree.brick.rootSize = {rootSize[0], rootSize[1], rootSize[2]};
  std::copy(roots.begin(), roots.end(), tree.brick.roots.begin());
  tree.brick.maxLevel = readArray<Id>(field, "BrickMaxLevel", 1, filter)[0];
  tree.brick.sidesArePatches = readArray<Id>(field, "BrickSidesArePatches", 1, filter)[0] != 0;
  const vtkIdType leaves = grid->GetNumberOfCells();
  tree.keys = readArray<Key>(grid->GetCellData(), "Key", leaves, filter);
  tree.levels = readArray<std::uint8_t>(grid->GetCellData(), "Level", leaves, filter);
  tree.cut = readArray<std::uint8_t>(grid->GetCellData(), "Cut", leaves, filter);
  tree.triangles.offsets.assign(leaves + 1, 0);
  if (octreeChecksum(tree) != stamp.sum) refuseChanged(filter, "its arrays have changed");
  tree.index();
  return tree;
}

}  // namespace pm
