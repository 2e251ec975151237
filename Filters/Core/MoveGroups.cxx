// SPDX-License-Identifier: BSD-3-Clause
#include "MoveGroups.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pm {
namespace {

constexpr double kBlockSize = 4;  // in finest cells: some twenty wall nodes, which fit in any cache

/// Sets of colours taken around cells; only cells that have a colour get one.
class Colours {
 public:
  static constexpr int kWords = 3, kMost = 64 * kWords;
  using Mask = std::array<std::uint64_t, kWords>;

  explicit Colours(std::size_t cells) : slotOf_(cells, kNone) {}

  void addTo(Mask& taken, Id cell) const {
    if (slotOf_[cell] == kNone) return;
    for (int w = 0; w < kWords; ++w) taken[w] |= used_[slotOf_[cell]][w];
  }
  void use(Id cell, int colour) {
    if (slotOf_[cell] == kNone) {
      slotOf_[cell] = static_cast<Id>(used_.size());
      used_.push_back({});
    }
    used_[slotOf_[cell]][colour / 64] |= std::uint64_t(1) << (colour % 64);
  }
  /// kMost when all are taken.
  static int firstFree(const Mask& taken) {
    int colour = 0;
    while (colour < kMost && (taken[colour / 64] >> (colour % 64) & 1)) ++colour;
    return colour;
  }

 private:
  std::vector<Id> slotOf_;
  std::vector<Mask> used_;
};

/// Cells of a row's points and of their bases, each once.
void gatherCells(const PolyMesh& mesh, const MoverRegion& region, Span<Id> row, std::vector<Id>& cells) {
  cells.clear();
  for (Id p : row)
    for (Id point : {p, mesh.base[p]}) {
      if (point == kNone || region.pointSlot[point] == kNone) continue;
      const Span<Id> own = region.pointCells[region.pointSlot[point]];
      cells.insert(cells.end(), own.begin(), own.end());
    }
  sortUnique(cells);
}

}  // namespace

std::vector<std::vector<Id>> groupRows(const PolyMesh& mesh, const MoverRegion& region, const Csr<Id>& rows) {
  // A move writes its cells and their faces and reads the cells across those faces; so two rows may share a
  // colour when no cell of one is a cell of the other or a face neighbour of one.
  Colours colours(mesh.cellCount);
  std::vector<std::vector<Id>> groups;
  std::vector<Id> cells, serial;
  for (Id i = 0; i < rows.rows(); ++i) {
    gatherCells(mesh, region, rows[i], cells);
    Colours::Mask taken{};
    for (Id c : cells)
      for (Id f : region.cellFaces[region.cellSlot[c]]) {
        colours.addTo(taken, mesh.owner[f]);
        if (f < mesh.internalFaces()) colours.addTo(taken, mesh.neighbour[f]);
      }
    const int colour = Colours::firstFree(taken);
    if (colour == Colours::kMost) {
      serial.push_back(i);
      continue;
    }
    for (Id c : cells) colours.use(c, colour);
    if (static_cast<int>(groups.size()) <= colour) groups.resize(colour + 1);
    groups[colour].push_back(i);
  }
  for (Id i : serial) groups.push_back({i});
  return groups;
}

MoveBlocks groupBlocks(const PolyMesh& mesh, const MoverRegion& region, const std::vector<Id>& points) {
  using Place = std::array<std::int64_t, 3>;
  Box box;
  for (Id p : points) box.add(mesh.points[p]);
  const auto placeOf = [&](Id p) {
    Place place;
    for (int a = 0; a < 3; ++a)
      place[a] = static_cast<std::int64_t>(
          std::floor((mesh.points[p][a] - box.lo[a]) / (kBlockSize * mesh.finestSize)));
    return place;
  };
  std::vector<std::pair<Place, std::size_t>> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = {placeOf(points[i]), i};
  std::sort(sorted.begin(), sorted.end());
  MoveBlocks blocks;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i > 0 && sorted[i].first != sorted[i - 1].first)
      blocks.points.offsets.push_back(static_cast<Id>(blocks.points.values.size()));
    blocks.points.values.push_back(points[sorted[i].second]);
  }
  if (!sorted.empty()) blocks.points.offsets.push_back(static_cast<Id>(blocks.points.values.size()));
  blocks.groups = groupRows(mesh, region, blocks.points);
  return blocks;
}

}  // namespace pm
