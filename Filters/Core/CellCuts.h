// SPDX-License-Identifier: BSD-3-Clause
// How each face and each cell of a mesh is cut, so that its cells become tetrahedra, or tetrahedra and
// pyramids beside cells that stay.
//
// A face is cut once, for both its cells: it stays whole, or becomes the triangles of the fan from one of its
// corners, or triangles about its centre. The pieces of a cell's faces, coned to an apex, are its new cells;
// the apex is one of the cell's own points, whose pieces then are no base, or a new point inside. A prism
// over a polygon may become wedges instead. So whatever is chosen is conformal, and two small numbers say it
// all.
//
// Sources: thesis 4.1 and 4.3 (central tetrahedra); J. Dompierre, P. Labbe, M.-G. Vallet, R. Camarero, "How
// to Subdivide Pyramids, Prisms, and Hexahedra into Tetrahedra", 1999 (fans by one order of all points, which
// fit between neighbours and, in a cell, fill it without a new point).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "Monitor.h"
#include "PolyMesh.h"

namespace pm {

struct CellCuts {
  static constexpr Id kWedges = -3;  ///< a prism over a polygon, cut over the polygon's fan
  static constexpr Id kWhole = -2;   ///< not cut
  static constexpr Id kCentre = -1;  ///< about a new point
  std::vector<Id> fan;               // #F kWhole, kCentre, or the corner (position in the face) of the fan
  std::vector<Id> apex;              // #C kWedges, kWhole, kCentre, or the point its pieces are coned to
  std::vector<Vec3> faceCentre;      // #F where the new point of a face would be
  std::vector<Vec3> cellCentre;      // #C where the new point of a cell would be
};

/// A triangle, or a quad that stays, of a face. A corner id of #P or above is the centre of face id - #P.
struct Piece {
  std::array<Id, 4> corner;
  int size;
  bool has(Id point) const {
    for (int i = 0; i < size; ++i)
      if (corner[i] == point) return true;
    return false;
  }
};

/// Pieces of a face of n corners that is cut so. kWhole: of three or four corners, or of a cell that stays.
inline Id countPieces(Id fan, std::size_t n) {
  return fan == CellCuts::kWhole ? 1 : static_cast<Id>(fan == CellCuts::kCentre ? n : n - 2);
}

/// Calls body(piece) for the pieces of a face, in the face's sense; those of a face that runs the other way
/// when turned. row: of at most four corners when the face is whole. centre: id of the face's centre.
template <class Body>
void forEachPiece(Span<Id> row, Id fan, Id centre, bool turned, const Body& body) {
  const std::size_t n = row.size();
  const auto emit = [&](Id a, Id b, Id c) {
    body(turned ? Piece{{a, c, b, kNone}, 3} : Piece{{a, b, c, kNone}, 3});
  };
  if (fan == CellCuts::kWhole && n == 4) {
    body(turned ? Piece{{row[0], row[3], row[2], row[1]}, 4} : Piece{{row[0], row[1], row[2], row[3]}, 4});
  } else if (fan == CellCuts::kCentre) {
    for (std::size_t i = 0; i < n; ++i) emit(centre, row[i], row[(i + 1) % n]);
  } else {
    const std::size_t base = fan == CellCuts::kWhole ? 0 : static_cast<std::size_t>(fan);
    for (std::size_t i = 1; i + 1 < n; ++i) emit(row[base], row[(base + i) % n], row[(base + i + 1) % n]);
  }
}

/// Shape of a tetrahedron whose d is on the side that b, c seen from a turn counter-clockwise: the cube of
/// its mean ratio (432 (6V)^2 / (sum of squared edges)^3), 1 when regular, with the sign of the volume.
inline double tetShape(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const double volume = ab.cross(ac).dot(ad);
  const double edges = ab.squaredNorm() + ac.squaredNorm() + ad.squaredNorm() + (c - b).squaredNorm() +
                       (d - b).squaredNorm() + (d - c).squaredNorm();
  return edges > 0 ? 432 * volume * std::abs(volume) / (edges * edges * edges) : 0.0;
}

/// Chooses the cuts, and better ones where the mesh that they make is not good enough.
///
/// Guarantees: no new cell is worse shaped than a fixed share of the worst central tetrahedron of its old
/// cell, when those have positive volume; a new point only where that would else not hold; every edge of a
/// piece is in pieces of one face, or an edge of the mesh, so that the result is conformal; the same choice
/// for any number of threads; linear time.
class CutChooser {
 public:
  /// hybrid: standard cells stay, and quads between cells; else only tetrahedra come out.
  CutChooser(const PolyMesh& mesh, bool hybrid);
  ~CutChooser();

  /// Throws InputError when a cell cannot be cut into cells of positive volume.
  const CellCuts& choose(Monitor& monitor);
  /// The same, with each of these cells a step nearer to its central tetrahedra: first coned to its centre,
  /// then with its faces cut about their centres too. Cells that stay, stay.
  const CellCuts& mend(const std::vector<Id>& cells, Monitor& monitor);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pm
