// SPDX-License-Identifier: BSD-3-Clause
// The prisms at the wall as columns that can be cut into layers, without touching the mesh.
//
// A prism edge joins a wall point to a lower point; it is named by its lower point, because several edges may
// end in one wall point (where wall nodes were merged) but not the other way round. Points at levels 1, 2, ..
// from the wall may lie on it. A column is a cell that contains a prism edge. It can be split when it is a
// prism in the general sense: one wall face or the parts of one, side faces that are quads or, below a merged
// wall edge, triangles, and other faces without wall points. Below parts of a wall face, the faces between
// layers can be in parts alike, so that a layer follows an edge of the geometry. Columns side by side may
// have different numbers of layers: the outermost cell of the one with fewer takes what the neighbour's
// further points add to its side faces, so every face is still shared by two cells.
#pragma once

#include <vector>

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
  Span<Id> ring(Id column) const { return rings_[column]; }  ///< lower points in the order of the wall
  Id wallPoint(Id lower) const {
    return top_[lower];
  }  ///< upper end of the edge; negative when there is none
  Span<Id> facesOf(Id cell) const { return facesOfCell_[cell]; }
  /// Columns that share a prism edge with this one, and itself; ascending.
  void around(Id column, std::vector<Id>& out) const;
  /// Columns behind this one's side faces, once for each face.
  template <class Body>
  void forEachBeside(Id column, const Body& body) const;

  Id layers(Id column) const { return layers_[column]; }
  Id layersOfCell(Id cell) const { return columnOf_[cell] == kNone ? 1 : layers_[columnOf_[cell]]; }
  void setLayers(Id column, Id layers) { layers_[column] = layers; }
  /// Layers of a prism edge: the most of any column around it. Call after setLayers, with all changed
  /// columns.
  void updateEdges(const std::vector<Id>& changedColumns);
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
  /// Faces between two layers of a column: one, or one below each face of its roof. Whole at first.
  Id capParts(Id column) const { return parted_[column] ? static_cast<Id>(roofs_[column].size()) : 1; }
  void partCaps(Id column) { parted_[column] = 1; }
  /// A face between layers `level` and level + 1 of a column; its normal points to the wall.
  void capRow(Id column, Id level, Id part, std::vector<Id>& row) const;

 private:
  static constexpr std::int8_t kNotSide = -1;

  void findEdges();
  void findSides();
  void findColumns();
  bool findRing(Id cell, std::vector<Id>& roof, std::vector<Id>& ring) const;
  bool isBelow(const std::vector<Id>& roof, const std::vector<Id>& ring) const;
  Id pointAt(Id lower, Id level) const;

  const PolyMesh& mesh_;
  Csr<Id> facesOfCell_;
  std::vector<Id> top_;                 // #P
  std::vector<std::int8_t> sideStart_;  // #F position of the first of the two lower points in a side face
  std::vector<Id> cells_, columnOf_;
  std::vector<char> parted_;  // #columns
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
