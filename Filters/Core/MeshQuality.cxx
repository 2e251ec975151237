// SPDX-License-Identifier: BSD-3-Clause
#include "MeshQuality.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numeric>

namespace pm {
namespace {

constexpr double kDegrees = 57.295779513082320877;
constexpr double kTiny = 1e-150;  // OpenFOAM's ROOTVSMALL
constexpr std::size_t kLocalPoints = 32;

/// Calls body(first, last) for blocks of [0, count), in parallel.
template <class Body>
void forBlocks(Id count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Id>(0, count, 1024),
                    [&](const tbb::blocked_range<Id>& range) { body(range.begin(), range.end()); });
}

/// Largest angle between two of the unit normals, eq 4-27; normals of no area are skipped.
double largestAngle(const Vec3* normals, std::size_t count) {
  double smallest = 1;
  for (std::size_t i = 0; i < count; ++i) {
    if (normals[i].isZero(0)) continue;
    for (std::size_t j = i + 1; j < count; ++j) {
      if (!normals[j].isZero(0)) smallest = std::min(smallest, normals[i].dot(normals[j]));
    }
  }
  return kDegrees * std::acos(std::max(-1.0, smallest));
}

/// Degradation of the central triangles (4-13) and warpage (4-27); centre is relative to origin.
void measureShape(const std::vector<Vec3>& points, Span<Id> row, const Vec3& origin, const Vec3& centre,
                  FaceMeasures& face) {
  const std::size_t n = row.size();
  std::array<Vec3, kLocalPoints> local;
  thread_local std::vector<Vec3> many;
  if (n > kLocalPoints) many.resize(n);
  Vec3* normals = n > kLocalPoints ? many.data() : local.data();

  face.eta = std::numeric_limits<double>::infinity();
  Vec3 a = points[row[n - 1]] - origin - centre;
  double lengthA = a.norm();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 b = points[row[i]] - origin - centre;
    const Vec3 twice = a.cross(b);
    const double twiceArea = twice.norm(), lengthB = b.norm(), edge = (b - a).norm();
    const double bound = std::max({edge, lengthA, lengthB}) * (edge + lengthA + lengthB);
    face.eta = std::min(face.eta, bound > 0 ? 2 * std::sqrt(3.0) * twiceArea / bound : 0.0);
    normals[i] = twiceArea > 0 ? Vec3(twice / twiceArea) : Vec3(Vec3::Zero());
    a = b;
    lengthA = lengthB;
  }
  face.warpage = n > 3 ? largestAngle(normals, n) : 0;
}

/// Different points of the faces, ascending.
void gatherPoints(const PolyMesh& mesh, Span<Id> facesOfCell, std::vector<Id>& out) {
  out.clear();
  for (Id f : facesOfCell) {
    for (Id p : mesh.faces[f]) out.push_back(p);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
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
  const std::size_t n = row.size();
  const Vec3 origin = points[row[0]];
  Vec3 average = Vec3::Zero();
  for (Id p : row) average += points[p] - origin;
  average /= static_cast<double>(n);

  FaceMeasures face;
  Vec3 moment = Vec3::Zero();
  double area = 0;
  Vec3 a = points[row[n - 1]] - origin - average;
  for (Id p : row) {
    const Vec3 b = points[p] - origin - average;
    const Vec3 twice = a.cross(b);
    const double twiceArea = twice.norm();
    face.normal += twice;
    moment += twiceArea * (a + b);
    area += twiceArea;
    a = b;
  }
  face.normal *= 0.5;
  const Vec3 centre = area > 0 ? Vec3(average + moment / (3 * area)) : average;
  face.centre = origin + centre;
  if (!quick) measureShape(points, row, origin, centre, face);
  return face;
}

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

MeshMeasures measure(const PolyMesh& mesh) {
  const Csr<Id> facesOfCell = cellFaces(mesh);
  MeshMeasures m;
  m.faces.resize(mesh.faceCount());
  forBlocks(mesh.faceCount(), [&](Id first, Id last) {
    for (Id f = first; f < last; ++f) m.faces[f] = measureFace(mesh.points, mesh.faces[f]);
  });
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
  return m;
}

}  // namespace pm
