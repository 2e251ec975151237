// SPDX-License-Identifier: BSD-3-Clause
// The prisms at the wall as columns that can be cut into layers, without touching the mesh.
//
// A prism edge joins a wall point to a lower point; it is named by its lower point, because several edges may
// end in one wall point (where wall nodes were merged) but not the other way round. Points at levels 1, 2, ..
// from the wall may lie on it. A column is a cell that contains a prism edge. It can be split when it is a
// prism in the general sense: one wall face or the parts of one, side faces that are quads or, below a merged
// wall edge, triangles, and other faces without wall points. An edge may be pinched: then the layers around
// it taper to its wall point, and no point of theirs lies on it. Columns side by side may have different
// numbers of layers: the outermost cell of the one with fewer takes what the neighbour's further points add
// to its side faces, so every face is still shared by two cells.
#pragma once

#include <array>
#include <vector>

#include "LayerReason.h"
#include "PolyMesh.h"

namespace pm {

class LayerColumns {
 public:
  /// The mesh must outlive the columns. All columns start with one layer.
  explicit LayerColumns(const PolyMesh& mesh);

  Id count() const { return static_cast<Id>(cells_.size()); }
  Id cell(Id column) const { return cells_[column]; }
  Id columnOf(Id cell) const { return columnOf_[cell]; }  ///< kNone for a cell without a prism edge
  /// Wall faces; none when the column cannot be split.
  Span<Id> roof(Id column) const { return roofs_[column]; }
  bool canSplit(Id column) const { return !roof(column).empty(); }
  Span<Id> ring(Id column) const { return rings_[column]; }       ///< lower points in the order of the wall
  Id pointCount() const { return static_cast<Id>(top_.size()); }  ///< of the mesh
  Id wallPoint(Id lower) const {
    return top_[lower];
  }  ///< upper end of the edge; negative when there is none
  Span<Id> facesOf(Id cell) const { return facesOfCell_[cell]; }
  /// Columns that share a prism edge with this one, and itself; ascending.
  void around(Id column, std::vector<Id>& out) const;
  Span<Id> columnsOf(Id lower) const { return edgeColumns_[lower]; }  ///< around a prism edge
  /// Columns behind this one's side faces, once for each face.
  template <class Body>
  void forEachBeside(Id column, const Body& body) const;

  Id layers(Id column) const { return layers_[column]; }
  Id layersOfCell(Id cell) const { return columnOf_[cell] == kNone ? 1 : layers_[columnOf_[cell]]; }
  void want(Id column, Id layers) {
    layers_[column] = layers;
    reason_[column] = LayerReason::None;
  }
  void setLayers(Id column, Id layers, LayerReason reason) {
    layers_[column] = layers;
    reason_[column] = reason;
  }
  /// Why a column has fewer layers than it was to have.
  LayerReason reason(Id column) const { return reason_[column]; }
  /// Layers of a prism edge: the most of any column around it. Call after want and setLayers, with all
  /// changed columns.
  void updateEdges(const std::vector<Id>& changedColumns);
  /// Layers end in the wall point of a pinched edge: none of their points are on it.
  void pinch(Id lower, bool pinched = true);
  bool isPinched(Id lower) const { return pinched_[lower]; }
  Id edgeLayers(Id lower) const { return edgeLayers_[lower]; }
  /// Gives the points on each edge consecutive ids from firstId, edges by ascending lower point; returns the
  /// next id.
  Id numberPoints(Id firstId);
  Id firstPoint(Id lower) const { return firstPoint_[lower]; }  ///< id of level 1, the others follow

  /// Faces that come of a face of the mesh, numbered 1, 2, .. from the wall.
  Id pieces(Id face) const;
  void pieceRow(Id face, Id piece, std::vector<Id>& row) const;
  /// Layer of `cell`, one beside the face, that the piece bounds.
  Id layerAt(Id cell, Id face, Id piece) const;
  bool isSide(Id face) const { return sideStart_[face] != kNotSide; }
  /// Lower ends of a side face's two prism edges, one after the other in the face.
  std::array<Id, 2> lowerEnds(Id face) const {
    const Span<Id> row = mesh_.faces[face];
    return {row[sideStart_[face]], row[(sideStart_[face] + 1) % row.size()]};
  }
  /// A face between layers `level` and level + 1 of a column; its normal points to the wall.
  void capRow(Id column, Id level, std::vector<Id>& row) const;

 private:
  static constexpr std::int8_t kNotSide = -1;

  void findEdges();
  void findSides();
  void findColumns();
  bool findRing(Id cell, std::vector<Id>& roof, std::vector<Id>& ring) const;
  bool isBelow(const std::vector<Id>& roof, const std::vector<Id>& ring) const;
  Id pointAt(Id lower, Id level) const;
  Id mostAround(Id lower) const;

  const PolyMesh& mesh_;
  Csr<Id> facesOfCell_;
  std::vector<Id> top_;                 // #P
  std::vector<std::int8_t> sideStart_;  // #F position of the first of the two lower points in a side face
  std::vector<Id> cells_, columnOf_;
  std::vector<char> pinched_;        // #P
  std::vector<LayerReason> reason_;  // #columns
  Csr<Id> roofs_, rings_;
  Csr<Id> edges_;        // of each column: lower points of all its prism edges
  Csr<Id> edgeColumns_;  // of each point: columns around its prism edge
  std::vector<Id> layers_, edgeLayers_, firstPoint_;
};

template <class Body>
void LayerColumns::forEachBeside(Id column, const Body& body) const {
  const Id own = cells_[column];
  for (Id f : facesOfCell_[own]) {
    if (!isSide(f) || f >= mesh_.internalFaces()) continue;
    const Id other = columnOf_[mesh_.owner[f] == own ? mesh_.neighbour[f] : mesh_.owner[f]];
    if (other != kNone) body(other);
  }
}

}  // namespace pm
