// SPDX-License-Identifier: BSD-3-Clause
#include "FoamQuality.h"

#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr double kDegrees = 57.295779513082320877;
constexpr double kTiny = 1e-150;  // OpenFOAM's ROOTVSMALL
constexpr double kSmall = 1e-15;  // its SMALL
constexpr double kGreat = 1e15;   // its GREAT

/// Diameter's half of the sphere through four points; kGreat when they lie in a plane.
double circumRadius(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double denominator = c.dot(b.cross(a));
  if (std::abs(denominator) < kTiny) return kGreat;
  const double lambda = c.squaredNorm() - a.dot(c), mu = b.squaredNorm() - a.dot(b);
  return 0.5 * (a + (lambda * b.cross(a) - mu * c.cross(a)) / denominator).norm();
}

/// Smallest quality of the tetrahedra over the triangles of the face's fan from one of its points; sign: 1
/// when the face's normal leaves the cell of that centre.
double fanQuality(const std::vector<Vec3>& points, Span<Id> row, std::size_t base, const Vec3& centre,
                  bool leaves) {
  double worst = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i + 1 < row.size(); ++i) {
    const Vec3& a = points[row[(base + i) % row.size()]];
    const Vec3& b = points[row[(base + i + 1) % row.size()]];
    worst = std::min(worst, tetQuality(centre, points[row[base]], leaves ? a : b, leaves ? b : a));
  }
  return worst;
}

double determinant(const PolyMesh& mesh, const MeshMeasures& measures, Span<Id> facesOfCell,
                   const Directions& solved) {
  thread_local std::vector<Vec3> areas;
  areas.clear();
  for (Id f : facesOfCell) {
    if (f < mesh.internalFaces()) areas.push_back(measures.faces[f].normal);
  }
  return cellDeterminant(areas.data(), areas.size(), solved);
}

double aspectRatio(const MeshMeasures& measures, Span<Id> facesOfCell, double volume,
                   const Directions& solved) {
  Vec3 sum = Vec3::Zero();
  for (Id f : facesOfCell) sum += measures.faces[f].normal.cwiseAbs();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (int a = 0; a < 3; ++a) {
    if (!solved[a]) continue;
    least = std::min(least, sum[a]);
    most = std::max(most, sum[a]);
  }
  const double ratio = most / (least + kTiny);
  if (!(solved[0] && solved[1] && solved[2])) return ratio;
  return std::max(ratio, sum.sum() / 6 / std::pow(std::max(kTiny, volume), 2.0 / 3));
}

/// Largest sine of the angle at which one face's centre stands before another face's plane.
double concavitySine(const PolyMesh& mesh, const MeshMeasures& measures, Id cell, Span<Id> facesOfCell) {
  double largest = -1;
  for (Id f : facesOfCell) {
    const FaceMeasures& face = measures.faces[f];
    const Vec3 outward =
        (mesh.owner[f] == cell ? 1.0 : -1.0) / std::max(face.normal.norm(), kTiny * kTiny) * face.normal;
    for (Id g : facesOfCell) {
      if (g == f) continue;
      const Vec3 to = measures.faces[g].centre - face.centre;
      largest = std::max(largest, to.dot(outward) / std::max(to.norm(), kTiny * kTiny));
    }
  }
  return largest;
}

void measureFace(const PolyMesh& mesh, const MeshMeasures& m, Id f, FoamMeasures& foam) {
  const Span<Id> row = mesh.faces[f];
  const FaceMeasures& face = m.faces[f];
  const CellMeasures& own = m.cells[mesh.owner[f]];
  foam.flatness[f] = faceFlatness(mesh.points, row, face);
  foam.concavity[f] = faceConcavity(mesh.points, row, face);
  if (f >= mesh.internalFaces()) {
    foam.skewness[f] = boundarySkewness(mesh.points, row, face, own.foamCentre);
    foam.tet[f] = faceTetQuality(mesh.points, row, face, own.foamCentre, nullptr);
    return;
  }
  const CellMeasures& next = m.cells[mesh.neighbour[f]];
  foam.skewness[f] = internalSkewness(mesh.points, row, face, own.foamCentre, next.foamCentre);
  foam.tet[f] = faceTetQuality(mesh.points, row, face, own.foamCentre, &next.foamCentre);
  foam.nonOrthogonality[f] = faceAngle(face.normal, next.foamCentre - own.foamCentre);
  foam.weight[f] = faceWeight(face, own.foamCentre, next.foamCentre);
  foam.volumeRatio[f] = volumeRatio(own.volume, next.volume);
}

void takeMeans(const PolyMesh& mesh, FoamMeasures& foam) {
  double cosines = 0, flatness = 0;
  Id polygons = 0;
  for (double angle : foam.nonOrthogonality) cosines += std::cos(angle / kDegrees);
  if (!foam.nonOrthogonality.empty())
    foam.meanNonOrthogonality =
        kDegrees * std::acos(std::min(1.0, cosines / static_cast<double>(foam.nonOrthogonality.size())));
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    if (mesh.faces[f].size() <= 3) continue;
    flatness += foam.flatness[f];
    ++polygons;
  }
  if (polygons > 0) foam.meanFlatness = flatness / polygons;
  const double planar = -kDegrees * kPlanarSine;
  foam.concaveCells = static_cast<Id>(std::count_if(foam.cells.begin(), foam.cells.end(),
                                                    [&](const FoamCell& c) { return c.concavity > planar; }));
}

}  // namespace

double cellDeterminant(const Vec3* areas, std::size_t count, const Directions& solved) {
  double mean = 0;
  for (std::size_t i = 0; i < count; ++i) mean += areas[i].norm();
  if (count == 0 || mean < kTiny) return 0;
  mean /= static_cast<double>(count);
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
  const double scale = 1 / mean;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 scaled = scale * areas[i];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b) tensor(a, b) += scaled[a] * scaled[b];
  }
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b) tensor(a, b) = tensor(b, a);
  for (int a = 0; a < 3; ++a) {
    if (!solved[a]) tensor(a, a) = 1;
  }
  return std::abs(tensor.determinant()) / 8;
}

double faceWeight(const FaceMeasures& face, const Vec3& ownerCentre, const Vec3& neighbourCentre) {
  const double own = std::abs(face.normal.dot(face.centre - ownerCentre));
  const double next = std::abs(face.normal.dot(neighbourCentre - face.centre));
  return own + next > 0 ? std::min(own, next) / (own + next) : 0;
}

double volumeRatio(double ownerVolume, double neighbourVolume) {
  const double own = std::abs(ownerVolume), next = std::abs(neighbourVolume);
  return std::max(own, next) > 0 ? std::min(own, next) / std::max(own, next) : 0;
}

double faceFlatness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face) {
  if (row.size() <= 3) return 1;
  double area = 0;
  Vec3 a = points[row[row.size() - 1]] - face.centre;
  for (Id p : row) {
    const Vec3 b = points[p] - face.centre;
    area += 0.5 * a.cross(b).norm();
    a = b;
  }
  return face.normal.norm() / (area + kTiny);
}

double faceConcavity(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face) {
  const std::size_t n = row.size();
  const auto edge = [&](std::size_t i) { return Vec3(points[row[(i + 1) % n]] - points[row[i]]); };
  double sine = 0;
  Vec3 before = edge(n - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 after = edge(i);
    const double lengths = before.norm() * after.norm();
    const Vec3 turn = before.cross(after) / (lengths + kTiny);
    if (lengths > 0 && turn.dot(face.normal) < kSmall * turn.norm() * face.normal.norm())
      sine = std::max(sine, turn.norm());
    before = after;
  }
  return kDegrees * std::asin(std::min(1.0, sine));
}

double tetQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const double volume = ab.cross(ac).dot(ad) / 6;
  const double radius = std::min(circumRadius(ab, ac, ad), kGreat);
  return volume / (8 / (9 * std::sqrt(3.0)) * radius * radius * radius + kTiny);
}

double faceTetQuality(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                      const Vec3& ownerCentre, const Vec3* neighbourCentre) {
  double worst = std::numeric_limits<double>::infinity(), best = -worst;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Vec3 &a = points[row[i]], &b = points[row[(i + 1) % row.size()]];
    worst = std::min(worst, -tetQuality(a, b, face.centre, ownerCentre));
    if (neighbourCentre) worst = std::min(worst, tetQuality(a, b, face.centre, *neighbourCentre));
    double fan = fanQuality(points, row, i, ownerCentre, true);
    if (neighbourCentre) fan = std::min(fan, fanQuality(points, row, i, *neighbourCentre, false));
    best = std::max(best, fan);
  }
  return std::min(worst, best);
}

double faceTetVolume(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                     const Vec3& ownerCentre, const Vec3* neighbourCentre, double enough) {
  const std::size_t n = row.size();
  const Vec3 toFace = face.centre - ownerCentre;
  const Vec3 fromFace = neighbourCentre ? Vec3(*neighbourCentre - face.centre) : toFace;
  double worst = std::numeric_limits<double>::infinity(), best = -worst;
  Vec3 a = points[row[n - 1]] - face.centre;
  for (Id p : row) {
    const Vec3 b = points[p] - face.centre, normal = a.cross(b);
    worst = std::min({worst, normal.dot(toFace), normal.dot(fromFace)});
    a = b;
  }
  for (std::size_t base = 0; base < n && best <= 6 * enough; ++base) {
    const Vec3& tip = points[row[base]];
    const Vec3 toTip = tip - ownerCentre, fromTip = neighbourCentre ? Vec3(*neighbourCentre - tip) : toTip;
    double fan = std::numeric_limits<double>::infinity();
    Vec3 c = points[row[(base + 1) % n]] - tip;
    for (std::size_t i = 2; i < n; ++i) {
      const Vec3 d = points[row[(base + i) % n]] - tip, normal = c.cross(d);
      fan = std::min({fan, normal.dot(toTip), normal.dot(fromTip)});
      c = d;
    }
    best = std::max(best, fan);
  }
  return std::min(worst, best) / 6;
}

FoamCell measureFoamCell(const PolyMesh& mesh, const MeshMeasures& measures, Id cell, Span<Id> facesOfCell,
                         const Directions& solved) {
  FoamCell result;
  result.aspectRatio = aspectRatio(measures, facesOfCell, measures.cells[cell].volume, solved);
  result.determinant = determinant(mesh, measures, facesOfCell, solved);
  const double sine = concavitySine(mesh, measures, cell, facesOfCell);
  result.concavity = kDegrees * std::asin(std::clamp(sine, -1.0, 1.0));
  return result;
}

FoamMeasures measureFoam(const PolyMesh& mesh, const MeshMeasures& measures, const Directions& solved,
                         Monitor& monitor) {
  FoamMeasures foam;
  for (std::vector<double>* values : {&foam.nonOrthogonality, &foam.weight, &foam.volumeRatio})
    values->resize(mesh.internalFaces());
  for (std::vector<double>* values : {&foam.skewness, &foam.flatness, &foam.concavity, &foam.tet})
    values->resize(mesh.faceCount());
  monitor.check(0.4, "measuring faces");
  tbb::parallel_for(Id(0), mesh.faceCount(), [&](Id f) { measureFace(mesh, measures, f, foam); });
  monitor.check(0.6, "measuring cells");
  foam.cells.resize(mesh.cellCount);
  const Csr<Id> facesOfCell = cellFaces(mesh);
  tbb::parallel_for(Id(0), mesh.cellCount, [&](Id c) {
    foam.cells[c] = measureFoamCell(mesh, measures, c, facesOfCell[c], solved);
  });
  takeMeans(mesh, foam);
  return foam;
}

}  // namespace pm
