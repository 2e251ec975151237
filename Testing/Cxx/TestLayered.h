// SPDX-License-Identifier: BSD-3-Clause
// From a surface to a mesh with a dummy layer, as the stages make it.
#pragma once

#include "DummyLayer.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "TestSurfaces.h"

namespace pm::testing {

inline PolyMesh layered(const SurfaceModel& model, const OctreeDecomposeOptions& octree,
                        Region region = Region::Inside) {
  Monitor monitor;
  PaintFrontOptions front;
  front.region = region;
  return dummyLayer(paintFront(decompose(model, octree, monitor), model, front, monitor), {}, monitor);
}
/// With cells of this size at the surface.
inline PolyMesh layered(const SurfaceModel& model, double size, Region region = Region::Inside) {
  OctreeDecomposeOptions octree;
  octree.featureSize = size;
  return layered(model, octree, region);
}

}  // namespace pm::testing
