// SPDX-License-Identifier: BSD-3-Clause
#include "CellCuts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "Chunks.h"
#include "MeshQuality.h"
#include "PointOrder.h"
#include "PolygonPrism.h"

namespace pm {
namespace {

constexpr double cubed(double x) { return x * x * x; }
constexpr double kGood = cubed(0.35);  // a mean ratio that needs no improvement
constexpr double kShare = cubed(0.5);  // of the worst central tetrahedron's, which is always to be had
constexpr double kPyramidShare =
    cubed(0.1);                  // of that, for a quad whose cutting would cost a cell that stays
constexpr double kFlat = 0.966;  // cosine of 15 degrees of warpage
constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kAlways = std::numeric_limits<double>::infinity();

/// Whether the cell is a tetrahedron, pyramid, wedge or hexahedron: so many triangles and quads, and so many
/// faces at each point.
bool isStandard(const PolyMesh& mesh, Span<Id> faces, Span<Id> points) {
  std::size_t triangles = 0, quads = 0;
  for (Id f : faces) {
    triangles += mesh.faces[f].size() == 3;
    quads += mesh.faces[f].size() == 4;
  }
  if (triangles + quads != faces.size()) return false;
  if (quads == 0) return triangles == 4 && points.size() == 4;
  if (quads == 1) return triangles == 4 && points.size() == 5;
  const bool counts = (quads == 3 && triangles == 2 && points.size() == 6) ||
                      (quads == 6 && triangles == 0 && points.size() == 8);
  return counts && std::all_of(points.begin(), points.end(), [&](Id p) {
           return std::count_if(faces.begin(), faces.end(), [&](Id f) {
                    const Span<Id> row = mesh.faces[f];
                    return std::find(row.begin(), row.end(), p) != row.end();
                  }) == 3;
         });
}

/// Goes from a point towards each of the targets by ever smaller parts of the way, where shape(place, enough)
/// is better there; it may answer anything below `enough` when it is not.
template <class PointOf, class Shape>
Vec3 climb(Vec3 at, Span<Id> targets, const PointOf& pointOf, const Shape& shape) {
  double best = shape(at, kNever);
  for (double part = 0.3; part > 0.03 && best < kGood; part /= 2) {
    for (Id target : targets) {
      const Vec3 trial = at + part * (pointOf(target) - at);
      const double now = shape(trial, best);
      if (!(now > best)) continue;
      best = now;
      at = trial;
    }
  }
  return at;
}

}  // namespace

class CutChooser::Impl {
 public:
  Impl(const PolyMesh& mesh, bool hybrid)
      : mesh_(mesh),
        hybrid_(hybrid),
        facesOf_(cellFaces(mesh)),
        pointsOf_(cellPoints(mesh)),
        facesAt_(pointFaces(mesh)),
        order_(mesh) {}

  const CellCuts& choose(Monitor& monitor) {
    placeCentres(monitor);
    startFaces(monitor);
    std::vector<Id> all(mesh_.cellCount);
    std::iota(all.begin(), all.end(), Id(0));
    improve(std::move(all), monitor);
    faceCentre_ = cuts_.faceCentre;
    cellCentre_ = cuts_.cellCentre;
    moveNewPoints(monitor);
    checkVolumes(monitor);
    return cuts_;
  }

  const CellCuts& mend(const std::vector<Id>& cells, Monitor& monitor) {
    cuts_.faceCentre = faceCentre_;  // with which central tetrahedra have volume
    cuts_.cellCentre = cellCentre_;
    std::vector<Id> again;
    for (Id c : cells) {
      if (cuts_.apex[c] == CellCuts::kWhole) continue;
      again.push_back(c);
      prism_[c] = 0;
      if (cuts_.apex[c] != CellCuts::kCentre) {
        centred_[c] = cuts_.apex[c] >= 0;
        continue;
      }
      for (Id f : facesOf_[c]) {
        if (cuts_.fan[f] == CellCuts::kWhole || cuts_.fan[f] == CellCuts::kCentre) continue;
        cuts_.fan[f] = CellCuts::kCentre;
        settled_[f] = 1;
        for (int side = 0; side < sidesOf(f); ++side) again.push_back(cellAt(f, side));
      }
    }
    sortUnique(again);
    improve(std::move(again), monitor);
    moveNewPoints(monitor);
    checkVolumes(monitor);
    return cuts_;
  }

 private:
  void placeCentres(Monitor& monitor) {
    cuts_.faceCentre.resize(mesh_.faceCount());
    forChunks(mesh_.faceCount(), monitor, 0.1, "face centres",
              [&](Id f) { cuts_.faceCentre[f] = measureFace(mesh_.points, mesh_.faces[f], true).centre; });
    cuts_.cellCentre.resize(mesh_.cellCount);
    needed_.resize(mesh_.cellCount);
    forChunks(mesh_.cellCount, monitor, 0.2, "cell centres", [&](Id c) {
      const CellMeasures cell = measureCell(mesh_, c, facesOf_[c], pointsOf_[c],
                                            [&](Id f) -> const Vec3& { return cuts_.faceCentre[f]; });
      cuts_.cellCentre[c] = cell.centre;
      needed_[c] = std::min(kGood, kShare * centralShape(c, cell.centre));
    });
  }

  /// Whether two points of a face are together in no other face: only then is a line between them an edge of
  /// this face's triangles alone.
  bool onlyHere(Id p, Id q) const {
    const Span<Id> a = facesAt_[p], b = facesAt_[q];
    int shared = 0;
    for (const Id *i = a.begin(), *j = b.begin(); i != a.end() && j != b.end() && shared < 2;) {
      shared += *i == *j;
      *i < *j ? ++i : *j < *i ? ++j : (++i, ++j);
    }
    return shared == 1;
  }

  /// Whether the fan from a corner has no edge that another face might have too.
  bool isFree(Id f, Id corner) const {
    const Span<Id> row = mesh_.faces[f];
    const std::size_t n = row.size();
    for (std::size_t i = 2; i + 1 < n; ++i)
      if (!onlyHere(row[corner], row[(corner + i) % n])) return false;
    return true;
  }

  /// Whether the wall is folded across the face, so that a fan might fold it the other way.
  bool isBent(Id f) const {
    return f >= mesh_.internalFaces() && measureFace(mesh_.points, mesh_.faces[f]).cosWarpage < kFlat;
  }

  /// The fan from the first point in the one order that is free.
  Id firstFan(Id f) const {
    const Span<Id> row = mesh_.faces[f];
    Id first = CellCuts::kCentre;
    if (isBent(f)) return first;
    for (Id corner = 0; corner < Id(row.size()); ++corner)
      if ((first == CellCuts::kCentre || order_.before(row[corner], row[first])) && isFree(f, corner))
        first = corner;
    return first;
  }

  /// Every face's fan begins at its first point in the one order, so that cells can have fans too.
  void startFaces(Monitor& monitor) {
    cuts_.fan.resize(mesh_.faceCount());
    settled_.resize(mesh_.faceCount());
    bad_.assign(2 * static_cast<std::size_t>(mesh_.faceCount()), 0);
    forChunks(mesh_.faceCount(), monitor, 0.3, "first cuts", [&](Id f) {
      const Span<Id> row = mesh_.faces[f];
      const bool whole = row.size() == 3 || (hybrid_ && row.size() == 4);
      cuts_.fan[f] = whole ? CellCuts::kWhole : firstFan(f);
      settled_[f] = row.size() == 3;
    });
    cuts_.apex.resize(mesh_.cellCount);
    centred_.assign(mesh_.cellCount, 0);
    standard_.resize(mesh_.cellCount);
    forChunks(mesh_.cellCount, monitor, 0.3, "first cuts",
              [&](Id c) { standard_[c] = isStandard(mesh_, facesOf_[c], pointsOf_[c]); });
    prism_.assign(mesh_.cellCount, 0);
    if (hybrid_) alignColumns();
  }

  /// Fans of the polygons of prisms one on the other begin at one edge along the column.
  void alignColumns() {
    std::vector<Id> prisms(2 * static_cast<std::size_t>(mesh_.faceCount()), kNone);  // at each polygon
    PolygonPrism prism;
    for (Id c = 0; c < mesh_.cellCount; ++c) {
      if (standard_[c] || !findPrism(mesh_, facesOf_[c], c, prism)) continue;
      prism_[c] = 1;
      for (Id f : {prism.base, prism.lid}) prisms[2 * f + (prisms[2 * f] != kNone)] = c;
    }
    for (Id f = 0; f < mesh_.faceCount(); ++f)  // the ends of columns
      if (prisms[2 * f] != kNone && prisms[2 * f + 1] == kNone) alignColumn(f, prisms);
  }

  void alignColumn(Id first, const std::vector<Id>& prisms) {
    std::vector<PolygonPrism> column;
    std::vector<Id> faces{first}, cells{prisms[2 * first]};
    while (cells.back() != kNone) {
      column.emplace_back();
      findPrism(mesh_, facesOf_[cells.back()], cells.back(), column.back());
      const Id f = column.back().base == faces.back() ? column.back().lid : column.back().base;
      faces.push_back(f);
      cells.push_back(prisms[2 * f] == cells.back() ? prisms[2 * f + 1] : prisms[2 * f]);
    }
    if (faces.back() < first) return;  // done from the other end
    double most = 0;
    for (Id start : mesh_.faces[first]) {
      std::vector<Id> fans;
      Id point = start;
      double worst = kAlways;
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const Span<Id> row = mesh_.faces[faces[i]];
        fans.push_back(static_cast<Id>(std::find(row.begin(), row.end(), point) - row.begin()));
        if (isBent(faces[i]) || !isFree(faces[i], fans.back())) worst = kNever;
        if (i == column.size()) break;
        const std::size_t corner = column[i].cornerOf(point);
        worst = std::min(worst, wedgeShape(column[i], corner));
        point = faces[i] == column[i].base ? column[i].above[corner] : column[i].below[corner];
      }
      if (!(worst > most)) continue;
      most = worst;
      for (std::size_t i = 0; i < faces.size(); ++i) cuts_.fan[faces[i]] = fans[i];
    }
  }

  /// Worst shape of the tetrahedra at the corners of a prism's wedges.
  double wedgeShape(const PolygonPrism& prism, std::size_t corner) const {
    double worst = kAlways;
    forEachWedge(prism, corner, [&](const std::array<Id, 3>& below, const std::array<Id, 3>& above) {
      for (int i = 0; i < 3; ++i) {
        const Id j = (i + 1) % 3, k = (i + 2) % 3;
        worst = std::min({worst, tetShape(at(below[i]), at(below[k]), at(below[j]), at(above[i])),
                          tetShape(at(above[i]), at(above[j]), at(above[k]), at(below[i]))});
      }
    });
    return worst;
  }

  /// Whether the fans of both polygons of a prism fit, its quads are whole, and its wedges have volume.
  bool becomesWedges(Id c) const {
    PolygonPrism prism;
    if (!prism_[c] || !findPrism(mesh_, facesOf_[c], c, prism)) return false;
    for (Id f : facesOf_[c])
      if (mesh_.faces[f].size() == 4 ? cuts_.fan[f] != CellCuts::kWhole : cuts_.fan[f] < 0) return false;
    const std::size_t corner = prism.cornerOf(mesh_.faces[prism.base][cuts_.fan[prism.base]]);
    return corner == prism.cornerOf(mesh_.faces[prism.lid][cuts_.fan[prism.lid]]) &&
           wedgeShape(prism, corner) > 0;
  }

  /// Cells choose; those that none of their apexes suits have the faces cut otherwise, once for each face.
  void improve(std::vector<Id> cells, Monitor& monitor) {
    for (double round = 0; !cells.empty(); ++round) {
      const double fraction = 0.9 - 0.5 / (1 + 0.3 * round);
      forChunks(static_cast<Id>(cells.size()), monitor, fraction, "cutting cells",
                [&](Id i) { chooseApex(cells[i]); });
      std::vector<Id> faces;
      for (Id c : cells)
        for (Id f : facesOf_[c])
          if (bad_[2 * f] || bad_[2 * f + 1]) faces.push_back(f);
      sortUnique(faces);
      forChunks(static_cast<Id>(faces.size()), monitor, fraction, "cutting faces",
                [&](Id i) { settle(faces[i]); });
      cells.clear();
      for (Id f : faces)
        for (int side = 0; side < sidesOf(f); ++side) cells.push_back(cellAt(f, side));
      sortUnique(cells);
    }
  }

  void chooseApex(Id c) {
    if (staysWhole(c)) {
      cuts_.apex[c] = CellCuts::kWhole;
      return;
    }
    if (prism_[c] && becomesWedges(c)) {
      cuts_.apex[c] = CellCuts::kWedges;
      return;
    }
    if (!centred_[c] && chooseOwnPoint(c)) return;
    cuts_.apex[c] = CellCuts::kCentre;
    for (Id f : facesOf_[c]) {
      if (settled_[f]) continue;
      const double shape = faceShape(f, cuts_.fan[f], c, cuts_.cellCentre[c], kNone);
      const bool quad = cuts_.fan[f] == CellCuts::kWhole && mesh_.faces[f].size() == 4;
      if (!(shape > 0) || shape < (quad ? kPyramidShare : 1) * needed_[c])
        bad_[2 * f + (mesh_.owner[f] != c)] = 1;
    }
  }

  /// Whether one of the cell's points is good enough: the first in the one order if it is, else the best.
  bool chooseOwnPoint(Id c) {
    const Id first = *order_.firstOf(pointsOf_[c]);
    cuts_.apex[c] = first;
    double best = coneShape(c, mesh_.points[first], first, needed_[c]);
    if (best >= needed_[c]) return true;
    for (Id p : pointsOf_[c]) {
      const double shape = coneShape(c, mesh_.points[p], p, best);
      if (!(shape > best)) continue;
      best = shape;
      cuts_.apex[c] = p;
    }
    return best >= needed_[c];
  }

  bool staysWhole(Id c) const {
    return standard_[c] && std::all_of(facesOf_[c].begin(), facesOf_[c].end(),
                                       [&](Id f) { return cuts_.fan[f] == CellCuts::kWhole; });
  }

  /// The fan that suits the centres of both cells best, or the face's centre when none suits.
  void settle(Id f) {
    settled_[f] = 1;
    bad_[2 * f] = bad_[2 * f + 1] = 0;
    const auto share = [&](Id fan) {
      double least = kAlways;
      for (int side = 0; side < sidesOf(f); ++side) {
        const Id c = cellAt(f, side);
        const double shape = faceShape(f, fan, c, cuts_.cellCentre[c], kNone);
        least = std::min(least, shape > 0 ? shape / std::max(needed_[c], 1e-300) : shape);
      }
      return least;
    };
    Id best = CellCuts::kCentre;
    cuts_.fan[f] = best;
    if (isBent(f)) return;
    double most = std::min(1.0, share(best));
    for (Id corner = 0; corner < Id(mesh_.faces[f].size()); ++corner) {
      const double now = share(corner);
      if (now < most || !isFree(f, corner)) continue;
      most = now;
      best = corner;
    }
    cuts_.fan[f] = best;
  }

  /// New points go where the worst of the cells at them is best; cells, then faces, do not depend on each
  /// other. Those of boundary faces stay, since they are the wall.
  void moveNewPoints(Monitor& monitor) {
    forChunks(mesh_.cellCount, monitor, 0.9, "moving new points", [&](Id c) {
      if (cuts_.apex[c] != CellCuts::kCentre) return;
      const auto centreOf = [&](Id f) -> const Vec3& { return cuts_.faceCentre[f]; };
      cuts_.cellCentre[c] =
          climb(cuts_.cellCentre[c], facesOf_[c], centreOf,
                [&](const Vec3& at, double enough) { return coneShape(c, at, kNone, enough); });
    });
    forChunks(mesh_.internalFaces(), monitor, 0.9, "moving new points", [&](Id f) {
      if (cuts_.fan[f] != CellCuts::kCentre) return;
      Vec3& centre = cuts_.faceCentre[f];
      const auto corner = [&](Id p) -> const Vec3& { return mesh_.points[p]; };
      centre = climb(centre, mesh_.faces[f], corner, [&](const Vec3& at, double) {
        centre = at;
        return std::min(shapeBelow(f, mesh_.owner[f]), shapeBelow(f, mesh_.neighbour[f]));
      });
    });
  }

  /// Worst shape of a cell's new cells on one of its faces.
  double shapeBelow(Id f, Id c) const {
    const Id apex = cuts_.apex[c];
    return faceShape(f, cuts_.fan[f], c, apex < 0 ? cuts_.cellCentre[c] : mesh_.points[apex], apex);
  }

  void checkVolumes(Monitor& monitor) {
    monitor.check(0.95, "checking volumes");
    std::vector<char> fails(mesh_.cellCount, 0);
    tbb::parallel_for(Id(0), mesh_.cellCount, [&](Id c) {
      const Id apex = cuts_.apex[c];
      if (apex < CellCuts::kCentre) return;
      const bool centre = apex == CellCuts::kCentre;
      fails[c] = !(coneShape(c, centre ? cuts_.cellCentre[c] : mesh_.points[apex], apex, 0) > 0);
    });
    const auto count = std::count(fails.begin(), fails.end(), 1);
    if (count > 0)
      throw InputError(fmt::format(
          "{} of the mesh's cells cannot be cut into cells of positive volume, the first is cell {}; Mesh "
          "Validity shows what is wrong with them.",
          count, std::find(fails.begin(), fails.end(), 1) - fails.begin()));
  }

  int sidesOf(Id f) const { return f < mesh_.internalFaces() ? 2 : 1; }
  Id cellAt(Id f, int side) const { return side == 0 ? mesh_.owner[f] : mesh_.neighbour[f]; }
  const Vec3& at(Id point) const {
    const Id count = static_cast<Id>(mesh_.points.size());
    return point < count ? mesh_.points[point] : cuts_.faceCentre[point - count];
  }

  /// Worst shape of the cells that the pieces of a face make with an apex; a pyramid's is that of its
  /// corners.
  double faceShape(Id f, Id fan, Id c, const Vec3& apex, Id apexPoint) const {
    double worst = kAlways;
    const Id centre = static_cast<Id>(mesh_.points.size()) + f;
    const Span<Id> row = mesh_.faces[f];
    if (apexPoint >= 0 && std::find(row.begin(), row.end(), apexPoint) != row.end()) {
      const bool fits = row.size() == 3 || (fan >= 0 && row[fan] == apexPoint);
      return fits ? kAlways : kNever;  // its pieces are faces of the cones on others
    }
    forEachPiece(row, fan, centre, mesh_.owner[f] != c, [&](const Piece& piece) {
      const auto corner = [&](int i) -> const Vec3& { return at(piece.corner[i % piece.size]); };
      for (int i = 0; i < (piece.size == 4 ? 4 : 1); ++i)
        worst = std::min(worst, tetShape(corner(i), corner(i + 2), corner(i + 1), apex));
    });
    return worst;
  }

  /// Worst shape of a cell's new cells; anything below `enough` when there is one as bad.
  double coneShape(Id c, const Vec3& apex, Id apexPoint, double enough) const {
    double worst = kAlways;
    for (Id f : facesOf_[c]) {
      worst = std::min(worst, faceShape(f, cuts_.fan[f], c, apex, apexPoint));
      if (worst < enough) break;
    }
    return worst;
  }

  double centralShape(Id c, const Vec3& apex) const {
    double worst = kAlways;
    for (Id f : facesOf_[c]) {
      const bool triangle = mesh_.faces[f].size() == 3;
      worst = std::min(worst, faceShape(f, triangle ? CellCuts::kWhole : CellCuts::kCentre, c, apex, kNone));
    }
    return worst;
  }

  const PolyMesh& mesh_;
  const bool hybrid_;
  const Csr<Id> facesOf_, pointsOf_, facesAt_;
  const PointOrder order_;
  CellCuts cuts_;
  std::vector<Vec3> faceCentre_, cellCentre_;  // before they were moved
  std::vector<double> needed_;                 // #C shape that is good enough
  std::vector<char> bad_;                      // #F by 2: a cell's centre wants the face cut otherwise
  std::vector<char> settled_;                  // #F the face is cut for good
  std::vector<char> standard_;                 // #C
  std::vector<char> prism_;                    // #C a prism over a polygon, that may become wedges
  std::vector<char> centred_;                  // #C the apex may not be a point of the cell's own
};

CutChooser::CutChooser(const PolyMesh& mesh, bool hybrid) : impl_(std::make_unique<Impl>(mesh, hybrid)) {}
CutChooser::~CutChooser() = default;
const CellCuts& CutChooser::choose(Monitor& monitor) { return impl_->choose(monitor); }
const CellCuts& CutChooser::mend(const std::vector<Id>& cells, Monitor& monitor) {
  return impl_->mend(cells, monitor);
}

}  // namespace pm
