// SPDX-License-Identifier: BSD-3-Clause
#include "MoverMeasures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "FoamQuality.h"
#include "QuadLanes.h"

namespace pm {
namespace {

constexpr std::size_t kMostFaces = 32, kMostCorners = 96;  // of a cell; a hexahedron has 6 and 24
constexpr double kTiny = 1e-150;                           // OpenFOAM's ROOTVSMALL

double cosine(const Vec3& normal, const Vec3& direction) {
  const double lengths = std::sqrt(normal.squaredNorm() * direction.squaredNorm());
  return lengths > 0 ? normal.dot(direction) / lengths : -1.0;
}

/// Area vectors of the central triangles of a cell's faces, twice as long: those of quads, and the others in
/// one row.
struct Triangles {
  std::array<FourVectors, kMostFaces> quads;
  std::array<Vec3, kMostCorners> others;
};

/// Sums over the central tetrahedra of a cell.
struct Moments {
  double volume = 0;
  Vec3 moment = Vec3::Zero();
};

void addQuad(const std::vector<Vec3>& points, const CellFace& face, const Vec3& apex, FourVectors& triangle,
             Moments& sums) {
  const FourVectors corner = quadCorners(points, face.row, *face.centre), before = corner.before();
  triangle = Four::all(face.sign) * before.cross(corner);
  const Four tet = (1.0 / 6) * triangle.dot(apex);
  const double volume = tet.sum();
  sums.volume += volume;
  sums.moment += (tet * (before + corner)).sum() + 3 * volume * apex;
}

void addPolygon(const std::vector<Vec3>& points, const CellFace& face, const Vec3& apex, Vec3* triangle,
                Moments& sums) {
  Vec3 a = points[face.row[face.row.size() - 1]] - *face.centre;
  for (Id p : face.row) {
    const Vec3 b = points[p] - *face.centre;
    *triangle = face.sign * a.cross(b);
    const double tet = triangle++->dot(apex) / 6;
    sums.volume += tet;
    sums.moment += tet * (a + b + 3 * apex);
    a = b;
  }
}

CellMeasures measureOneByOne(const std::vector<Vec3>& points, Span<Id> pointsOfCell, Span<CellFace> faces) {
  return measureCell(points, pointsOfCell, [&](const auto& body) {
    for (const CellFace& face : faces) body(face.row, face.sign > 0 ? 1 : -1, *face.centre);
  });
}

/// faceTetVolume of a quad with corners relative to its centre.
double quadTetVolume(const FourVectors& corner, const Vec3& toFace, const Vec3& fromFace, double enough) {
  const FourVectors triangle = corner.before().cross(corner);
  const double worst = std::min(triangle.dot(toFace).least(), triangle.dot(fromFace).least());
  const auto at = [&](int k) {
    const auto lane = [k](const Four& v) { return k < 2 ? v.lo[k] : v.hi[k - 2]; };
    return Vec3(lane(corner.x), lane(corner.y), lane(corner.z));
  };
  double best = -std::numeric_limits<double>::infinity();
  for (int base = 0; base < 2 && best <= 6 * enough; ++base) {
    const Vec3 tip = at(base), across = at(base + 2) - tip;
    const Vec3 first = (at(base + 1) - tip).cross(across), second = across.cross(at((base + 3) % 4) - tip);
    const Vec3 toTip = toFace + tip, fromTip = fromFace - tip;
    best = std::max(best,
                    std::min({first.dot(toTip), first.dot(fromTip), second.dot(toTip), second.dot(fromTip)}));
  }
  return std::min(worst, best) / 6;
}

/// Both numbers at once.
using Two = Four::Two;
Two squareRoots(double a, double b) { return Two{std::sqrt(a), std::sqrt(b)}; }

/// What relate() tells of a quad inside the mesh. Square roots and divisions, its main cost, go in pairs.
FaceRelation relateQuad(const std::vector<Vec3>& points, Span<Id> row, const Vec3& centre, const Vec3& normal,
                        const CellMeasures& own, const CellMeasures& next, double enough) {
  const Vec3 toFace = centre - own.foamCentre, fromFace = next.foamCentre - centre;
  const Vec3 d = next.foamCentre - own.foamCentre, thesis = next.centre - own.centre;
  const double area2 = normal.squaredNorm(), d2 = d.squaredNorm();
  const double along = normal.dot(d), first = normal.dot(toFace);
  const Two lengths = squareRoots(area2 * thesis.squaredNorm(), area2 * d2);
  const Two cosines = Two{normal.dot(thesis), along} / lengths;
  FaceRelation r;
  r.cosAngle = lengths[0] > 0 && lengths[1] > 0 ? std::min(cosines[0], cosines[1]) : -1;

  const double a = std::abs(first), b = std::abs(normal.dot(fromFace));
  const double v = std::abs(own.volume), w = std::abs(next.volume);
  const Two ratios = Two{std::min(a, b), std::min(v, w)} / Two{a + b, std::max(v, w)};
  r.weight = a + b > 0 ? ratios[0] : 0;
  r.volumeRatio = std::max(v, w) > 0 ? ratios[1] : 0;

  const FourVectors corner = quadCorners(points, row, centre);
  const Vec3 offset = toFace - (first / (along + kTiny)) * d;
  const Two extents = squareRoots(offset.squaredNorm(), d2);
  const Four reach = corner.dot(Vec3((1 / (extents[0] + kTiny)) * offset));
  r.skew = extents[0] / std::max({0.2 * extents[1] + kTiny, reach.most(), -reach.least()});
  r.tet = quadTetVolume(corner, toFace, fromFace, enough);
  return r;
}

}  // namespace

CellMeasures measureCell(const std::vector<Vec3>& points, Span<Id> pointsOfCell, Span<CellFace> faces) {
  std::size_t corners = 0;
  for (const CellFace& face : faces) corners += face.row.size();
  if (corners > kMostCorners || faces.size() > kMostFaces)
    return measureOneByOne(points, pointsOfCell, faces);

  const Vec3 origin = points[pointsOfCell[0]];
  Vec3 average = Vec3::Zero(), estimate = Vec3::Zero();
  for (Id p : pointsOfCell) average += points[p] - origin;
  average /= static_cast<double>(pointsOfCell.size());
  for (const CellFace& face : faces) estimate += *face.centre - origin;
  estimate /= static_cast<double>(faces.size());

  // Central tetrahedra about the average, and OpenFOAM's pyramids about the mean of the face centres.
  Triangles triangles;
  Moments central, foam;
  std::size_t quads = 0, others = 0;
  for (const CellFace& face : faces) {
    const Vec3 at = *face.centre - origin, apex = at - average;
    const double pyramid = face.sign * face.normal->dot(at - estimate);
    foam.volume += pyramid;
    foam.moment += pyramid * (0.75 * at + 0.25 * estimate);
    if (face.row.size() == 4) {
      addQuad(points, face, apex, triangles.quads[quads++], central);
    } else {
      addPolygon(points, face, apex, &triangles.others[others], central);
      others += face.row.size();
    }
  }
  const Vec3 centre = central.volume != 0 ? Vec3(average + central.moment / (4 * central.volume)) : average;
  const Vec3 foamCentre = foam.volume != 0 ? Vec3(foam.moment / foam.volume) : estimate;

  CellMeasures cell;
  cell.volume = central.volume;
  cell.centre = origin + centre;
  cell.foamCentre = origin + foamCentre;
  double tet = std::numeric_limits<double>::infinity(), pyramid = tet;
  quads = others = 0;
  for (const CellFace& face : faces) {
    const Vec3 at = *face.centre - origin, apex = at - centre;
    pyramid = std::min(pyramid, face.sign * face.normal->dot(at - foamCentre));
    if (face.row.size() == 4) {
      tet = std::min(tet, triangles.quads[quads++].dot(apex).least());
    } else {
      for (std::size_t k = 0; k < face.row.size(); ++k)
        tet = std::min(tet, triangles.others[others++].dot(apex));
    }
  }
  cell.minTet = tet / 6;
  cell.minPyramid = pyramid / 3;
  return cell;
}

FaceRelation relate(const std::vector<Vec3>& points, Span<Id> row, const Vec3& centre, const Vec3& normal,
                    const CellMeasures& own, const CellMeasures* next, double enough) {
  FaceMeasures face;
  face.centre = centre;
  face.normal = normal;
  FaceRelation r;
  if (next == nullptr) {
    r.cosAngle = cosine(normal, centre - own.centre);
    r.skew = boundarySkewness(points, row, face, own.foamCentre);
    r.tet = faceTetVolume(points, row, face, own.foamCentre, nullptr, enough);
    return r;
  }
  if (row.size() == 4) return relateQuad(points, row, centre, normal, own, *next, enough);
  r.cosAngle =
      std::min(cosine(normal, next->centre - own.centre), cosine(normal, next->foamCentre - own.foamCentre));
  r.weight = faceWeight(face, own.foamCentre, next->foamCentre);
  r.volumeRatio = volumeRatio(own.volume, next->volume);
  r.skew = internalSkewness(points, row, face, own.foamCentre, next->foamCentre);
  r.tet = faceTetVolume(points, row, face, own.foamCentre, &next->foamCentre, enough);
  return r;
}

}  // namespace pm
