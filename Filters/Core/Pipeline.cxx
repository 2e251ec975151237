// SPDX-License-Identifier: BSD-3-Clause
#include "Pipeline.h"

namespace pm {
namespace {

/// Null when holes are left as they are.
std::unique_ptr<SurfaceModel> withoutHoles(const SurfaceModel& model, const PipelineOptions& options,
                                           Monitor& monitor, PipelineReport& report) {
  if (options.closeHoles == HoleMethod::ShowOnly) return nullptr;
  CloseHolesOptions holes;
  holes.method = options.closeHoles;
  const bool outside = options.front.region == Region::Outside;
  (outside ? holes.search.insidePoints : holes.search.outsidePoints) = options.front.keepOut;
  if (options.front.region == Region::Points) holes.search.insidePoints = options.front.points;
  return closeHoles(model, options.octree, holes, monitor, &report.holes);
}

}  // namespace

PolyMesh runPipeline(const SurfaceModel& given, const PipelineOptions& options, Monitor& monitor,
                     PipelineReport* report) {
  PipelineReport local;
  PipelineReport& r = report ? *report : local;
  const std::unique_ptr<SurfaceModel> closed = withoutHoles(given, options, monitor, r);
  const SurfaceModel& model = closed ? *closed : given;
  PolyMesh mesh;
  {
    const Octree tree = decompose(model, options.octree, monitor);
    mesh = paintFront(tree, model, options.front, monitor, &r.front);
  }
  if (options.stopAfter <= Stage::Front) return mesh;
  mesh = dummyLayer(std::move(mesh), options.layer, monitor);
  if (options.stopAfter <= Stage::Layer) return mesh;
  DistanceField field(model, mesh.finestSize);
  project(mesh, field, options.project, monitor);
  if (options.stopAfter <= Stage::Projected) return mesh;
  resolveFeatures(mesh, field, options.features, monitor, &r.features);
  if (options.stopAfter <= Stage::Resolved) return mesh;
  return boundaryRefine(std::move(mesh), options.refine, monitor, &r.refine);
}

}  // namespace pm
