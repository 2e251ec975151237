// SPDX-License-Identifier: BSD-3-Clause
#include "SizeField.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace pm {
namespace {

constexpr int kDepth = 3;

/// Does the cell come within `reach` of the shape with that distance function? Yes when that cannot be told.
template <class Distance>
bool within(const Box& cell, double reach, const Distance& distance, int depth = kDepth) {
  const Vec3 centre = cell.centre(), half = 0.5 * cell.size();
  const double d = distance(centre);
  if (d - reach > half.norm()) return false;
  if (d - reach <= half.minCoeff() || depth == 0) return true;
  for (int k = 0; k < 8; ++k) {
    Box part;
    for (int a = 0; a < 3; ++a) {
      part.lo[a] = k >> a & 1 ? centre[a] : cell.lo[a];
      part.hi[a] = k >> a & 1 ? cell.hi[a] : centre[a];
    }
    if (within(part, reach, distance, depth - 1)) return true;
  }
  return false;
}

double distanceTo(const RefineCylinder& cylinder, const Vec3& p) {
  const Vec3 axis = cylinder.end - cylinder.start;
  const double length = axis.norm();
  const double along = axis.dot(p - cylinder.start) / length;
  const double across = (p - cylinder.start - along / length * axis).norm();
  return std::hypot(std::max({0.0, -along, along - length}), std::max(0.0, across - cylinder.radius));
}

std::shared_ptr<const SurfaceModel> patchSurface(const SurfaceModel& model, Id patch) {
  std::vector<SurfaceModel::Triangle> triangles;
  for (Id t = 0; t < model.triangleCount(); ++t)
    if (model.patchOf(t) == patch) triangles.push_back(model.triangles()[t]);
  if (triangles.empty()) return nullptr;
  return std::make_shared<SurfaceModel>(model.points(), triangles, std::vector<Id>(triangles.size(), 0),
                                        std::vector<std::string>{model.patchNames()[patch]});
}

}  // namespace

SizeField::SizeField(const SurfaceModel& model, const OctreeDecomposeOptions& options) : options_(options) {
  addPatchDistances(model);
  for (const SurfaceDistance& row : options.surfaceDistances)
    if (options.sizeSurface)
      near_.push_back({options.sizeSurface, row.distance, row.size, {RefineReason::SurfaceDistance, 0, -1}});
}

SizeField::~SizeField() = default;

void SizeField::addPatchDistances(const SurfaceModel& model) {
  std::map<Id, std::shared_ptr<const SurfaceModel>> surfaces;
  for (const PatchDistance& row : options_.patchDistances)
    for (Id patch = 0; patch < static_cast<Id>(model.patchNames().size()); ++patch) {
      if (model.patchNames()[patch] != row.patch) continue;
      if (surfaces.count(patch) == 0) surfaces[patch] = patchSurface(model, patch);
      if (surfaces[patch])
        near_.push_back(
            {surfaces[patch], row.distance, row.size, {RefineReason::PatchDistance, 0, narrowPatch(patch)}});
    }
}

bool SizeField::empty() const {
  return options_.boxes.empty() && options_.spheres.empty() && options_.cylinders.empty() && near_.empty();
}

RefineCause SizeField::asks(const Box& cell, double edge, double& limit) const {
  const auto tooLarge = [&](double size) {
    limit = size;
    return edge > size;
  };
  for (const RefineBox& r : options_.boxes)
    if (tooLarge(r.size) && r.box.overlaps(cell)) return {RefineReason::Box, 0, -1};
  for (const RefineSphere& r : options_.spheres)
    if (tooLarge(r.size) && cell.distance2(r.centre) <= r.radius * r.radius)
      return {RefineReason::Sphere, 0, -1};
  for (const RefineCylinder& r : options_.cylinders)
    if (tooLarge(r.size) && within(cell, 0, [&](const Vec3& p) { return distanceTo(r, p); }))
      return {RefineReason::Cylinder, 0, -1};
  for (const Near& r : near_)
    if (tooLarge(r.size) &&
        r.surface->bounds().distance2(cell.centre()) <=
            (r.distance + cell.diagonal()) * (r.distance + cell.diagonal()) &&
        within(cell, r.distance, [&](const Vec3& p) { return std::sqrt(r.surface->closest(p).distance2); }))
      return r.cause;
  return {};
}

}  // namespace pm
