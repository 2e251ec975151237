// SPDX-License-Identifier: BSD-3-Clause
#include "PointOrder.h"

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace pm {
namespace {

constexpr double kStraight = 0.94;  // cosine of 20 degrees

/// Whether the face goes straight on at one of its points.
bool straightAt(const std::vector<Vec3>& points, Span<Id> row, Id point) {
  const std::size_t n = row.size();
  const std::size_t i = std::find(row.begin(), row.end(), point) - row.begin();
  const Vec3 in = points[point] - points[row[(i + n - 1) % n]],
             out = points[row[(i + 1) % n]] - points[point];
  return in.dot(out) > kStraight * in.norm() * out.norm();
}

Vec3 unitNormal(const std::vector<Vec3>& points, Span<Id> row) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < row.size(); ++i)
    normal += (points[row[i]] - points[row[0]]).cross(points[row[i + 1]] - points[row[0]]);
  return normal.normalized();
}

/// A face at a point, as one of its cells has it.
struct Side {
  Id cell;
  Vec3 normal;  // out of the cell
};

/// Whether all faces that one of the cells has at the point lie in one plane. sides: of the point, by cell.
bool flatAt(const std::vector<Side>& sides) {
  for (std::size_t first = 0, last; first < sides.size(); first = last) {
    bool flat = true;
    for (last = first; last < sides.size() && sides[last].cell == sides[first].cell; ++last)
      flat &= sides[last].normal.dot(sides[first].normal) > kStraight;
    if (flat) return true;
  }
  return false;
}

}  // namespace

PointOrder::PointOrder(const PolyMesh& mesh) : hanging_(mesh.points.size()), along_(mesh.points.size()) {
  Box box;
  for (const Vec3& p : mesh.points) box.add(p);
  const Csr<Id> facesOf = pointFaces(mesh);
  std::vector<Vec3> normal(mesh.faceCount());
  tbb::parallel_for(Id(0), mesh.faceCount(),
                    [&](Id f) { normal[f] = unitNormal(mesh.points, mesh.faces[f]); });
  tbb::parallel_for(Id(0), static_cast<Id>(mesh.points.size()), [&](Id p) {
    thread_local std::vector<Side> sides;
    sides.clear();
    bool straight = false;
    for (Id f : facesOf[p]) {
      straight |= straightAt(mesh.points, mesh.faces[f], p);
      sides.push_back({mesh.owner[f], normal[f]});
      if (f < mesh.internalFaces()) sides.push_back({mesh.neighbour[f], -normal[f]});
    }
    std::stable_sort(sides.begin(), sides.end(),
                     [](const Side& a, const Side& b) { return a.cell < b.cell; });
    hanging_[p] = flatAt(sides) ? 2 : straight ? 1 : 0;
    along_[p] = (mesh.points[p] - box.lo).sum();
  });
}

}  // namespace pm
