// SPDX-License-Identifier: BSD-3-Clause
#include "Pipeline.h"

namespace pm {

PolyMesh runPipeline(const SurfaceModel& model, const PipelineOptions& options, Monitor& monitor,
                     PipelineReport* report) {
  PipelineReport local;
  PipelineReport& r = report ? *report : local;
  PolyMesh mesh;
  {
    const Octree tree = decompose(model, options.octree, monitor);
    mesh = paintFront(tree, model, options.front, monitor, &r.front);
  }
  if (options.stopAfter <= Stage::Front) return mesh;
  mesh = dummyLayer(mesh, options.layer, monitor);
  if (options.stopAfter <= Stage::Layer) return mesh;
  DistanceField field(model, mesh.finestSize);
  project(mesh, field, options.project, monitor);
  if (options.stopAfter <= Stage::Projected) return mesh;
  resolveFeatures(mesh, field, options.features, monitor, &r.features);
  if (options.stopAfter <= Stage::Resolved) return mesh;
  return boundaryRefine(mesh, options.refine, monitor, &r.refine);
}

}  // namespace pm
