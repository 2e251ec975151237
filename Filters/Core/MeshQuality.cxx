// SPDX-License-Identifier: BSD-3-Clause
#include "MeshQuality.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numeric>

#include "QuadLanes.h"

namespace pm {
namespace {

constexpr double kDegrees = 57.295779513082320877;
constexpr double kTiny = 1e-150;  // OpenFOAM's ROOTVSMALL

/// Calls body(first, last) for blocks of [0, count), in parallel.
template <class Body>
void forBlocks(Id count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Id>(0, count, 1024),
                    [&](const tbb::blocked_range<Id>& range) { body(range.begin(), range.end()); });
}

/// The central triangles of a face with N corners, or of any number when N is 0: triangle i lies between
/// corners i - 1 and i. A known number lets the compiler keep a quad in registers; most faces are quads.
template <std::size_t N>
struct Fan {
  std::array<Vec3, N> corner, normal;
  std::array<double, N> area, length, edge;
  static constexpr std::size_t size() { return N; }
};
template <>
struct Fan<0> {
  explicit Fan(std::size_t n) : corner(n), normal(n), area(n), length(n), edge(n) {}
  std::vector<Vec3> corner, normal;
  std::vector<double> area, length, edge;
  std::size_t size() const { return corner.size(); }
};

template <class Fan>
void findNormals(Fan& fan) {
  const std::size_t n = fan.size();
  for (std::size_t i = 0; i < n; ++i) fan.normal[i] = fan.corner[i ? i - 1 : n - 1].cross(fan.corner[i]);
  for (std::size_t i = 0; i < n; ++i) fan.area[i] = std::sqrt(fan.normal[i].squaredNorm());
}

/// Degradation of the central triangles (4-13); corners are relative to the face's centre.
template <class Fan>
double degradation(Fan& fan) {
  const std::size_t n = fan.size();
  const auto before = [n](std::size_t i) { return i ? i - 1 : n - 1; };
  for (std::size_t i = 0; i < n; ++i) fan.length[i] = std::sqrt(fan.corner[i].squaredNorm());
  for (std::size_t i = 0; i < n; ++i)
    fan.edge[i] = std::sqrt((fan.corner[i] - fan.corner[before(i)]).squaredNorm());
  double eta = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const double a = fan.length[before(i)], b = fan.length[i], c = fan.edge[i];
    const double bound = std::max({a, b, c}) * (a + b + c);
    eta = std::min(eta, bound > 0 ? 2 * std::sqrt(3.0) * fan.area[i] / bound : 0.0);
  }
  return eta;
}

/// Cosine of the largest angle between the central triangles' normals (4-27); those of no area are skipped.
template <class Fan>
double cosineOfWarpage(Fan& fan) {
  const std::size_t n = fan.size();
  if (n == 3) return 1;
  for (std::size_t i = 0; i < n; ++i) {
    if (fan.area[i] > 0) fan.normal[i] *= 1 / fan.area[i];
  }
  double smallest = 1;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (fan.area[i] > 0 && fan.area[j] > 0) smallest = std::min(smallest, fan.normal[i].dot(fan.normal[j]));
    }
  }
  return std::max(-1.0, smallest);
}

template <class Fan>
FaceMeasures measureFan(const std::vector<Vec3>& points, Span<Id> row, bool quick, Fan& fan) {
  const std::size_t n = fan.size();
  const Vec3 origin = points[row[0]];
  Vec3 average = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    fan.corner[i] = points[row[i]] - origin;
    average += fan.corner[i];
  }
  average /= static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) fan.corner[i] -= average;
  findNormals(fan);

  FaceMeasures face;
  Vec3 moment = Vec3::Zero();
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    face.normal += fan.normal[i];
    moment += fan.area[i] * (fan.corner[i ? i - 1 : n - 1] + fan.corner[i]);
    area += fan.area[i];
  }
  face.normal *= 0.5;
  const Vec3 shift = area > 0 ? Vec3(moment / (3 * area)) : Vec3(Vec3::Zero());
  face.centre = origin + (average + shift);
  if (quick) return face;

  for (std::size_t i = 0; i < n; ++i) fan.corner[i] -= shift;
  findNormals(fan);
  face.eta = degradation(fan);
  face.cosWarpage = cosineOfWarpage(fan);
  return face;
}

/// measureFan for a quad; the same formulas, corner by corner at once.
FaceMeasures measureQuad(const std::vector<Vec3>& points, Span<Id> row, bool quick) {
  const Vec3 origin = points[row[0]];
  FourVectors corner = quadCorners(points, row, origin);
  const Vec3 average = 0.25 * corner.sum();
  corner = corner - average;
  FourVectors before = corner.before(), normal = before.cross(corner);
  Four area = normal.length();

  FaceMeasures face;
  face.normal = 0.5 * normal.sum();
  const double sum = area.sum();
  const Vec3 shift = sum > 0 ? Vec3((area * (before + corner)).sum() / (3 * sum)) : Vec3(Vec3::Zero());
  face.centre = origin + (average + shift);
  if (quick) return face;

  corner = corner - shift;
  before = corner.before();
  normal = before.cross(corner);
  area = normal.length();
  const Four length = corner.length(), previous = length.before(), edge = (corner - before).length();
  const Four bound = larger(larger(previous, length), edge) * (previous + length + edge);
  if (!(area.least() > 0)) {  // a triangle of no area has no quality, and no normal
    face.eta = 0;
    Fan<4> fan;
    for (std::size_t i = 0; i < 4; ++i) fan.corner[i] = points[row[i]] - face.centre;
    findNormals(fan);
    face.cosWarpage = cosineOfWarpage(fan);
    return face;
  }
  face.eta = 2 * std::sqrt(3.0) * (area / bound).least();
  const FourVectors unit = (Four::all(1) / area) * normal;
  face.cosWarpage =
      std::clamp(std::min(unit.dot(unit.before()).least(), unit.dot(unit.across()).least()), -1.0, 1.0);
  return face;
}

/// Different points of the faces, ascending.
void gatherPoints(const PolyMesh& mesh, Span<Id> facesOfCell, std::vector<Id>& out) {
  out.clear();
  for (Id f : facesOfCell) {
    for (Id p : mesh.faces[f]) out.push_back(p);
  }
  sortUnique(out);
}

/// |sum of area vectors| over the sum of their lengths; 1 when there is no area.
double openness(const PolyMesh& mesh, Id cell, Span<Id> facesOfCell, const std::vector<FaceMeasures>& faces) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (Id f : facesOfCell) {
    if (mesh.owner[f] == cell) {
      sum += faces[f].normal;
    } else {
      sum -= faces[f].normal;
    }
    area += faces[f].normal.norm();
  }
  return area > 0 ? sum.norm() / area : 1;
}

/// Offset of the face's centre from where the line along d pierces its plane, over the face's extent that
/// way.
double skewness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face, const Vec3& toFace,
                const Vec3& d, double smallestExtent) {
  const Vec3 offset = toFace - (face.normal.dot(toFace) / (face.normal.dot(d) + kTiny)) * d;
  const double length = offset.norm();
  const Vec3 direction = offset / (length + kTiny);
  double extent = smallestExtent + kTiny;
  for (Id p : row) extent = std::max(extent, std::abs(direction.dot(points[p] - face.centre)));
  return length / extent;
}

}  // namespace

FaceMeasures measureFace(const std::vector<Vec3>& points, Span<Id> row, bool quick) {
  const auto measureWith = [&](auto fan) { return measureFan(points, row, quick, fan); };
  switch (row.size()) {
    case 3:
      return measureWith(Fan<3>());
    case 4:
      return measureQuad(points, row, quick);
    case 5:
      return measureWith(Fan<5>());
    default:
      return measureWith(Fan<0>(row.size()));
  }
}

double FaceMeasures::warpage() const { return kDegrees * std::acos(cosWarpage); }

Csr<Id> cellPoints(const PolyMesh& mesh) {
  const Csr<Id> facesOfCell = cellFaces(mesh);
  Csr<Id> rows;
  rows.offsets.assign(static_cast<std::size_t>(mesh.cellCount) + 1, 0);
  const auto forEachCell = [&](const auto& body) {
    forBlocks(mesh.cellCount, [&](Id first, Id last) {
      std::vector<Id> own;
      for (Id c = first; c < last; ++c) {
        gatherPoints(mesh, facesOfCell[c], own);
        body(c, own);
      }
    });
  };
  forEachCell([&](Id c, const std::vector<Id>& own) { rows.offsets[c + 1] = static_cast<Id>(own.size()); });
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.values.resize(rows.offsets.back());
  forEachCell([&](Id c, const std::vector<Id>& own) {
    std::copy(own.begin(), own.end(), rows.values.begin() + rows.offsets[c]);
  });
  return rows;
}

double faceAngle(const Vec3& normal, const Vec3& direction) {
  const double lengths = normal.norm() * direction.norm();
  if (!(lengths > 0)) return 180;
  return kDegrees * std::acos(std::clamp(normal.dot(direction) / lengths, -1.0, 1.0));
}

double internalSkewness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                        const Vec3& ownerCentre, const Vec3& neighbourCentre) {
  const Vec3 d = neighbourCentre - ownerCentre;
  return skewness(points, row, face, face.centre - ownerCentre, d, 0.2 * d.norm());
}

double boundarySkewness(const std::vector<Vec3>& points, Span<Id> row, const FaceMeasures& face,
                        const Vec3& ownerCentre) {
  const Vec3 toFace = face.centre - ownerCentre;
  const Vec3 unit = face.normal / (face.normal.norm() + kTiny);
  const Vec3 d = unit * unit.dot(toFace);
  return skewness(points, row, face, toFace, d, 0.4 * d.norm());
}

namespace {

void measureCells(const PolyMesh& mesh, MeshMeasures& m) {
  const Csr<Id> facesOfCell = cellFaces(mesh);
  m.cells.resize(mesh.cellCount);
  m.openness.resize(mesh.cellCount);
  forBlocks(mesh.cellCount, [&](Id first, Id last) {
    std::vector<Id> own;
    for (Id c = first; c < last; ++c) {
      gatherPoints(mesh, facesOfCell[c], own);
      const Span<Id> ids{own.data(), own.data() + own.size()};
      m.cells[c] =
          measureCell(mesh, c, facesOfCell[c], ids, [&](Id f) -> const Vec3& { return m.faces[f].centre; });
      m.openness[c] = static_cast<float>(openness(mesh, c, facesOfCell[c], m.faces));
    }
  });
}

/// Angle and skewness of faces, from the centres of their cells.
void measureBetween(const PolyMesh& mesh, MeshMeasures& m) {
  m.faceAngle.resize(mesh.faceCount());
  m.faceSkew.resize(mesh.faceCount());
  const Id internal = mesh.internalFaces();
  forBlocks(mesh.faceCount(), [&](Id first, Id last) {
    for (Id f = first; f < last; ++f) {
      const FaceMeasures& face = m.faces[f];
      const Vec3& own = m.cells[mesh.owner[f]].centre;
      const Vec3& next = f < internal ? m.cells[mesh.neighbour[f]].centre : face.centre;
      const Vec3& foamOwn = m.cells[mesh.owner[f]].foamCentre;
      const Vec3& foamNext = f < internal ? m.cells[mesh.neighbour[f]].foamCentre : face.centre;
      m.faceAngle[f] = static_cast<float>(faceAngle(face.normal, next - own));
      m.faceSkew[f] = static_cast<float>(
          f < internal ? internalSkewness(mesh.points, mesh.faces[f], face, foamOwn, foamNext)
                       : boundarySkewness(mesh.points, mesh.faces[f], face, foamOwn));
    }
  });
}

}  // namespace

MeshMeasures measure(const PolyMesh& mesh) {
  MeshMeasures m;
  m.faces.resize(mesh.faceCount());
  forBlocks(mesh.faceCount(), [&](Id first, Id last) {
    for (Id f = first; f < last; ++f) m.faces[f] = measureFace(mesh.points, mesh.faces[f]);
  });
  measureCells(mesh, m);
  measureBetween(mesh, m);
  return m;
}

}  // namespace pm
