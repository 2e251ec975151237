// SPDX-License-Identifier: BSD-3-Clause
#include "LayerSplit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

/// Puts the chosen layers into a mesh.
class Splitter {
 public:
  Splitter(const PolyMesh& mesh, LayerColumns& columns) : mesh_(mesh), columns_(columns) {}

  PolyMesh split(const std::vector<Vec3>& candidates) {
    numberCells();
    copyPoints(candidates);
    copyCells();
    splitFaces();
    out_.patchNames = mesh_.patchNames;
    out_.patchTypes = mesh_.patchTypes;
    out_.finestSize = mesh_.finestSize;
    out_.stage = Stage::Refined;
    canonicalise(out_);
    return std::move(out_);
  }

 private:
  /// Layer 1 keeps the column's cell; the others are appended, column by column.
  void numberCells() {
    nextCell_.assign(1, mesh_.cellCount);
    for (Id c = 0; c < columns_.count(); ++c) nextCell_.push_back(nextCell_.back() + columns_.layers(c) - 1);
    out_.cellCount = nextCell_.back();
  }
  Id cellAt(Id cell, Id layer) const {
    return layer == 1 ? cell : nextCell_[columns_.columnOf(cell)] + layer - 2;
  }

  /// candidates hold points of edges that have lost layers since; those that are left move up.
  void copyPoints(const std::vector<Vec3>& candidates) {
    const Id old = static_cast<Id>(mesh_.points.size());
    std::vector<Id> from(old);
    for (Id b = 0; b < old; ++b) from[b] = columns_.firstPoint(b);
    const Id count = columns_.numberPoints(old);
    out_.points = mesh_.points;
    out_.fixed = mesh_.fixed;
    out_.base = mesh_.base;
    out_.points.resize(count);
    out_.fixed.resize(count, 0);
    out_.base.resize(count, kNone);
    for (Id b = 0; b < old; ++b) {
      const Id inner = columns_.edgeLayers(b) - 1;
      if (inner == 0) continue;
      const Id wall = columns_.wallPoint(b), to = columns_.firstPoint(b);
      for (Id i = 0; i < inner; ++i) {
        out_.points[to + i] = candidates[from[b] + i];
        out_.fixed[to + i] = mesh_.fixed[wall] & mesh_.fixed[b];
      }
      if (mesh_.base[wall] == b) out_.base[wall] = to;
    }
  }

  void copyCells() {
    out_.level = mesh_.level;
    out_.layer = mesh_.layer;
    out_.level.resize(out_.cellCount);
    out_.layer.resize(out_.cellCount);
    out_.zone = mesh_.zone;
    out_.zoneNames = mesh_.zoneNames;
    if (!out_.zone.empty()) out_.zone.resize(out_.cellCount);
    for (Id c = 0; c < columns_.count(); ++c) {
      const Id cell = columns_.cell(c);
      for (Id layer = 2; layer <= columns_.layers(c); ++layer) {
        out_.level[cellAt(cell, layer)] = mesh_.level[cell];
        out_.layer[cellAt(cell, layer)] = static_cast<std::uint8_t>(layer);
        if (!out_.zone.empty()) out_.zone[cellAt(cell, layer)] = mesh_.zone[cell];
      }
    }
  }

  /// A source of faces: an internal face, a column's caps, or a boundary face, in this order.
  Id sources() const { return mesh_.faceCount() + columns_.count(); }
  Id facesFrom(Id source) const {
    const Id internal = mesh_.internalFaces();
    if (source < internal) return columns_.pieces(source);
    if (source < internal + columns_.count()) return columns_.layers(source - internal) - 1;
    return columns_.pieces(source - columns_.count());
  }
  /// The k-th face (from 1) of a source.
  void makeFace(Id source, Id k, std::vector<Id>& row, Id& owner, Id& neighbour) const {
    const Id internal = mesh_.internalFaces();
    if (source >= internal && source < internal + columns_.count()) {
      const Id column = source - internal;
      columns_.capRow(column, k, row);
      owner = cellAt(columns_.cell(column), k + 1);
      neighbour = cellAt(columns_.cell(column), k);
      return;
    }
    const Id face = source < internal ? source : source - columns_.count();
    columns_.pieceRow(face, k, row);
    owner = cellAt(mesh_.owner[face], columns_.layerAt(mesh_.owner[face], face, k));
    if (face >= internal) return;
    neighbour = cellAt(mesh_.neighbour[face], columns_.layerAt(mesh_.neighbour[face], face, k));
  }

  template <class Body>
  void forEachFace(const std::vector<Id>& start, const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<Id>(0, sources(), 1024), [&](const tbb::blocked_range<Id>& range) {
      std::vector<Id> row;
      for (Id source = range.begin(); source != range.end(); ++source) {
        for (Id f = start[source]; f < start[source + 1]; ++f) {
          Id owner = kNone, neighbour = kNone;
          makeFace(source, f - start[source] + 1, row, owner, neighbour);
          body(f, row, owner, neighbour, source);
        }
      }
    });
  }

  void splitFaces() {
    std::vector<Id> start(1, 0);
    for (Id source = 0; source < sources(); ++source) start.push_back(start.back() + facesFrom(source));
    const Id faces = start.back(), internal = start[mesh_.internalFaces() + columns_.count()];
    out_.faces.offsets.assign(static_cast<std::size_t>(faces) + 1, 0);
    out_.owner.resize(faces);
    out_.neighbour.resize(internal);
    out_.patch.resize(faces - internal);
    const Id boundaryShift = mesh_.internalFaces() + columns_.count();
    forEachFace(start, [&](Id f, const std::vector<Id>& row, Id owner, Id neighbour, Id source) {
      out_.faces.offsets[f + 1] = static_cast<Id>(row.size());
      out_.owner[f] = owner;
      if (f < internal) {
        out_.neighbour[f] = neighbour;
      } else {
        out_.patch[f - internal] = mesh_.patch[source - boundaryShift];
      }
    });
    std::vector<Id>& offsets = out_.faces.offsets;
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    out_.faces.values.resize(offsets.back());
    forEachFace(start, [&](Id f, const std::vector<Id>& row, Id, Id, Id) {
      std::copy(row.begin(), row.end(), out_.faces.values.begin() + offsets[f]);
    });
  }

  const PolyMesh& mesh_;
  LayerColumns& columns_;
  PolyMesh out_;
  std::vector<Id> nextCell_;  // of each column: its cell of layer 2
};

}  // namespace

PolyMesh splitLayers(const PolyMesh& mesh, LayerColumns& columns, const std::vector<Vec3>& candidates) {
  return Splitter(mesh, columns).split(candidates);
}

}  // namespace pm
