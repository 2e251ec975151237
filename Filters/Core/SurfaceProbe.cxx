// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceProbe.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "TriangleBox.h"

namespace pm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kRays = 8;     // triangles of a cell from which rays start
constexpr std::size_t kNormals = 8;  // triangles of a cell that the fit of the curvature uses

}  // namespace

SurfaceProbe::SurfaceProbe(const SurfaceModel& model, const Brick& brick,
                           const OctreeDecomposeOptions& options)
    : model_(model),
      options_(options),
      brick_(brick),
      finest_(brick.edge(brick.maxLevel)),
      cosFacing_(std::cos(options.closeAngle * kPi / 180)),
      cosSharp_(std::cos(options.sharpAngle * kPi / 180)) {}

Id SurfaceProbe::nodeAt(const OctreeBuilder& builder, const Vec3& p, int level) const {
  Coord c;
  for (int a = 0; a < 3; ++a)
    c[a] = static_cast<std::int32_t>(
        std::floor((p[a] - brick_.origin[a]) / brick_.rootSize[a] * double(1 << brick_.maxLevel)));
  return builder.find(c, level);
}

double SurfaceProbe::rayLength(const OctreeBuilder& builder, const Vec3& from, const Vec3& along, double most,
                               double step, int level, Id own) const {
  double nearest = std::numeric_limits<double>::infinity();
  Id last = kNone;
  for (double at = 0; at < std::min(most, nearest) + step; at += step) {
    const Id node = nodeAt(builder, from + at * along, level);
    if (node == kNone || node == last) continue;
    last = node;
    for (Id t : builder.triangles(builder.node(node))) {
      if (t == own || std::abs(model_.normal(t).dot(along)) < cosFacing_) continue;
      const double d = rayHit(from, along, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2));
      if (d >= 0.5 * finest_) nearest = std::min(nearest, d);
    }
  }
  return nearest;
}

void SurfaceProbe::markRay(const OctreeBuilder& builder, const Vec3& from, const Vec3& along, double length,
                           const Node& n, Id patch, std::vector<Mark>& marks) const {
  const double edge = brick_.edge(n.level), half = 0.5 * edge;
  int main = 0;
  along.cwiseAbs().maxCoeff(&main);
  const auto mark = [&](const Vec3& p) {
    const Id node = nodeAt(builder, p, n.level);
    if (node != kNone && builder.node(node).level == n.level) marks.push_back({node, patch});
  };
  const int steps = std::max(1, static_cast<int>(std::ceil(length / half)));
  for (int s = 0; s <= steps; ++s) {
    const Vec3 p = from + (length * s / steps) * along;
    mark(p);
    for (int axis = 0; axis < 3; ++axis)  // half a cell to the sides: the next ray starts a cell further
      if (axis != main)
        for (double d : {-half, half}) mark(p + d * Vec3::Unit(axis));
  }
}

void SurfaceProbe::gap(const OctreeBuilder& builder, const Node& n, Id index,
                       std::vector<Mark>& marks) const {
  const Span<Id> list = builder.triangles(n);
  const std::size_t count = std::min(list.size(), kRays);
  const Box box = builder.box(n);
  const double edge = brick_.edge(n.level);
  for (std::size_t i = 0; i < count; ++i) {
    const Id t = list[i * list.size() / count];
    const Vec3 from = cutCentre(box, model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2));
    const Vec3 spread = model_.normal(t).cwiseAbs();
    const double cells = spread.sum() + options_.gapCells * spread.maxCoeff();
    for (double sign : {-1.0, 1.0}) {
      const Vec3 along = sign * model_.normal(t);
      const double most = edge * cells * (1 - 1e-9);
      const double width = rayLength(builder, from, along, most, 0.25 * edge, n.level, t);
      if (width >= most) continue;
      marks.push_back({index, model_.patchOf(t)});
      markRay(builder, from, along, width, n, model_.patchOf(t), marks);
    }
  }
}

bool SurfaceProbe::bends(const OctreeBuilder& builder, const Node& n) const {
  const Span<Id> own = builder.triangles(n);
  const Vec3 reference = model_.normal(own[0]);
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = reference.unitOrthogonal();
  tangents.col(1) = reference.cross(tangents.col(0));
  std::array<Eigen::Vector2d, 27 * kNormals> place, turn;
  std::size_t count = 0;
  Eigen::Vector2d meanPlace = Eigen::Vector2d::Zero(), meanTurn = Eigen::Vector2d::Zero();
  for (int k = 0; k < 27; ++k) {
    const Id other = builder.neighbour(n, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1});
    if (other == kNone) continue;
    const Span<Id> list = builder.triangles(builder.node(other));
    const std::size_t sample = std::min(list.size(), kNormals);
    for (std::size_t i = 0; i < sample; ++i) {
      const Id t = list[i * list.size() / sample];
      const double cosine = model_.normal(t).dot(reference);
      if (std::abs(cosine) < cosSharp_) continue;
      const Vec3 centre = (model_.corner(t, 0) + model_.corner(t, 1) + model_.corner(t, 2)) / 3;
      place[count] = tangents.transpose() * (centre - model_.corner(own[0], 0));
      turn[count] = tangents.transpose() * (std::copysign(1.0, cosine) * model_.normal(t));
      meanPlace += place[count];
      meanTurn += turn[count++];
    }
  }
  if (count < 2) return false;
  meanPlace /= double(count);
  meanTurn /= double(count);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero(), product = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d x = place[i] - meanPlace;
    spread += x * x.transpose();
    product += (turn[i] - meanTurn) * x.transpose();
  }
  if (!(spread.trace() > 0)) return false;
  spread += 1e-6 * spread.trace() * Eigen::Matrix2d::Identity();  // all on a line: no curvature across it
  const Eigen::Matrix2d shape = product * spread.inverse();
  const Eigen::Matrix2d symmetric = 0.5 * (shape + shape.transpose());
  const double kappa = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(symmetric, Eigen::EigenvaluesOnly)
                           .eigenvalues()
                           .cwiseAbs()
                           .maxCoeff();
  return brick_.edge(n.level) * options_.cellsPerCircle * kappa > 2 * kPi * (1 + 1e-6);
}

}  // namespace pm
