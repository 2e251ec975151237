// SPDX-License-Identifier: BSD-3-Clause
#include "SideColumns.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <tuple>

namespace pm {
namespace {

class Extruder {
 public:
  Extruder(const PolyMesh& in, const SideColumns& columns)
      : in_(in), columns_(columns), layers_(columns.layers) {}

  PolyMesh run() {
    out_ = in_;
    namePatches();
    findColumns();
    addPoints();
    addCells();
    joinColumns();
    finish();
    return std::move(out_);
  }

 private:
  Id faceOf(Id boundaryFace) const { return in_.internalFaces() + boundaryFace; }
  Span<Id> row(Id boundaryFace) const { return in_.faces[faceOf(boundaryFace)]; }
  Id cellAt(Id column, int layer) const {  // layer from 1
    return in_.cellCount + (layer - 1) * static_cast<Id>(foot_.size()) + column;
  }
  Id pointAt(Id p, int layer) const {  // layer from 0
    return layer == 0
               ? p
               : static_cast<Id>(in_.points.size()) + (layer - 1) * static_cast<Id>(moved_.size()) + slot_[p];
  }

  /// A new patch for the outermost faces, in place of those that grow into it.
  void namePatches() {
    const Id count = static_cast<Id>(in_.patchNames.size());
    newPatch_.resize(count);
    if (columns_.outerPatch.empty()) {
      for (Id i = 0; i < count; ++i) newPatch_[i] = i;
      return;
    }
    out_.patchNames.clear();
    out_.patchTypes.clear();
    for (Id i = 0; i < count; ++i) {
      newPatch_[i] = columns_.extend[i] ? kNone : static_cast<Id>(out_.patchNames.size());
      if (columns_.extend[i]) continue;
      out_.patchNames.push_back(in_.patchNames[i]);
      out_.patchTypes.push_back(in_.patchTypes[i]);
    }
    std::string name = columns_.outerPatch;
    while (std::count(out_.patchNames.begin(), out_.patchNames.end(), name)) name += "_domain";
    for (Id& patch : newPatch_)
      if (patch == kNone) patch = static_cast<Id>(out_.patchNames.size());
    out_.patchNames.push_back(name);
    out_.patchTypes.push_back("patch");
  }

  void findColumns() {
    column_.assign(in_.boundaryFaces(), kNone);
    slot_.assign(in_.points.size(), kNone);
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      if (!columns_.extend[in_.patch[b]]) continue;
      column_[b] = static_cast<Id>(foot_.size());
      foot_.push_back(b);
      for (Id p : row(b)) slot_[p] = 0;
    }
    for (std::size_t p = 0; p < slot_.size(); ++p) {
      if (slot_[p] == kNone) continue;
      slot_[p] = static_cast<Id>(moved_.size());
      moved_.push_back(static_cast<Id>(p));
    }
    const double most = std::numeric_limits<Id>::max();
    if ((double(moved_.size()) + 4.0 * double(foot_.size())) * 4 * layers_ + double(in_.faces.values.size()) >
        most)
      throw BudgetError(
          "The far field would have more cells than can be numbered; allow fewer layers or a larger "
          "expansion "
          "ratio.");
  }

  void addPoints() {
    const std::size_t old = in_.points.size(), added = moved_.size() * std::size_t(layers_);
    out_.points.resize(old + added);
    out_.base.resize(old + added, kNone);
    out_.fixed.resize(old + added);
    tbb::parallel_for(std::size_t(0), moved_.size(), [&](std::size_t i) {
      const Vec3& x = in_.points[moved_[i]];
      const std::uint8_t kept = columns_.fixed(x, false);
      out_.fixed[moved_[i]] = in_.fixed[moved_[i]] & kept;
      for (int k = 1; k <= layers_; ++k) {
        const Id p = pointAt(moved_[i], k);
        out_.points[p] = columns_.place(x, k);
        out_.fixed[p] = k < layers_ ? kept : columns_.fixed(x, true);
      }
    });
  }

  void addCells() {
    for (int k = 1; k <= layers_; ++k)
      for (Id b : foot_) {
        const Id cell = in_.owner[faceOf(b)];
        out_.level.push_back(in_.level[cell]);
        if (!in_.zone.empty()) out_.zone.push_back(in_.zone[cell]);
      }
    out_.cellCount = static_cast<Id>(out_.level.size());
    out_.layer.resize(out_.cellCount, 0);
    for (Id f = 0; f < in_.internalFaces(); ++f) addInner(in_.faces[f], in_.owner[f], in_.neighbour[f]);
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      const Id foot = in_.owner[faceOf(b)], column = column_[b];
      if (column == kNone) {
        addOuter(row(b), foot, in_.patch[b]);
        continue;
      }
      for (int k = 0; k < layers_; ++k)
        addInner(lifted(row(b), k), k == 0 ? foot : cellAt(column, k), cellAt(column, k + 1));
      addOuter(lifted(row(b), layers_), cellAt(column, layers_), in_.patch[b]);
    }
  }

  /// The lateral faces: between two columns, or on a side that stays.
  void joinColumns() {
    struct Half {
      Id lo, hi, face;
      bool forward;
    };
    std::vector<Half> halves;
    for (Id b = 0; b < in_.boundaryFaces(); ++b) {
      const Span<Id> r = row(b);
      for (std::size_t i = 0; i < r.size(); ++i) {
        const Id p = r[i], q = r[(i + 1) % r.size()];
        if (slot_[p] != kNone && slot_[q] != kNone)
          halves.push_back({std::min(p, q), std::max(p, q), b, p < q});
      }
    }
    tbb::parallel_sort(halves.begin(), halves.end(), [](const Half& s, const Half& t) {
      return std::tie(s.lo, s.hi, s.face) < std::tie(t.lo, t.hi, t.face);
    });
    for (std::size_t i = 0; i + 1 < halves.size(); i += 2) {
      const Half &s = halves[i], &t = halves[i + 1];
      if (s.lo != t.lo || s.hi != t.hi)
        throw InternalError("The boundary is not manifold: an edge has not two faces.");
      const Half &own = column_[s.face] != kNone ? s : t, &across = column_[s.face] != kNone ? t : s;
      if (column_[own.face] == kNone) continue;
      addLateral(own.forward ? own.lo : own.hi, own.forward ? own.hi : own.lo, own.face, across.face);
    }
  }

  /// a -> b: an edge of the foot `face` as it runs there; across: the boundary face on its other side.
  void addLateral(Id a, Id b, Id face, Id across) {
    const Id patch = in_.patch[across];
    if (in_.isWallPatch(patch)) refuseWall(in_.patch[face], patch);
    for (int k = 0; k < layers_; ++k) {
      const std::array<Id, 4> quad{pointAt(a, k), pointAt(b, k), pointAt(b, k + 1), pointAt(a, k + 1)};
      const Id cell = cellAt(column_[face], k + 1);
      if (column_[across] != kNone) {
        addInner(quad, cell, cellAt(column_[across], k + 1));
      } else {
        addOuter(quad, cell, patch);
      }
    }
  }

  [[noreturn]] void refuseWall(Id side, Id wall) const {
    throw InputError(
        fmt::format("The geometry (patch {}) touches the domain side {}, which is to be extended; do not "
                    "extend this side, or "
                    "mesh a domain whose side is clear of the geometry.",
                    in_.patchNames[wall], in_.patchNames[side]));
  }

  std::vector<Id> lifted(Span<Id> row, int layer) const {
    std::vector<Id> ids;
    for (Id p : row) ids.push_back(pointAt(p, layer));
    return ids;
  }
  template <class Row>
  void addInner(const Row& row, Id owner, Id neighbour) {
    inner_.push(row);
    owner_.push_back(owner);
    neighbour_.push_back(neighbour);
  }
  template <class Row>
  void addOuter(const Row& row, Id owner, Id patch) {
    outer_.push(row);
    outerOwner_.push_back(owner);
    outerPatch_.push_back(newPatch_[patch]);
  }

  void finish() {
    const Id start = inner_.offsets.back();
    for (std::size_t i = 1; i < outer_.offsets.size(); ++i)
      inner_.offsets.push_back(start + outer_.offsets[i]);
    inner_.values.insert(inner_.values.end(), outer_.values.begin(), outer_.values.end());
    owner_.insert(owner_.end(), outerOwner_.begin(), outerOwner_.end());
    out_.faces = std::move(inner_);
    out_.owner = std::move(owner_);
    out_.neighbour = std::move(neighbour_);
    out_.patch = std::move(outerPatch_);
    canonicalise(out_);
  }

  const PolyMesh& in_;
  const SideColumns& columns_;
  const int layers_;
  std::vector<Id> newPatch_;  // of each old patch
  std::vector<Id> column_;    // of each boundary face, kNone = it has none
  std::vector<Id> foot_;      // boundary face of each column
  std::vector<Id> slot_;      // of each point among the moved ones
  std::vector<Id> moved_;     // points of the feet, ascending
  Csr<Id> inner_, outer_;
  std::vector<Id> owner_, neighbour_, outerOwner_, outerPatch_;
  PolyMesh out_;
};

}  // namespace

PolyMesh growColumns(const PolyMesh& mesh, const SideColumns& columns) {
  return Extruder(mesh, columns).run();
}

}  // namespace pm
