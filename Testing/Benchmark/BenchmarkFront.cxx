// SPDX-License-Identifier: BSD-3-Clause
// Painting, repair and mesh of the front for octrees of 1e5 to 6e6 leaves.
#include <benchmark/benchmark.h>

#include <cmath>

#include "BumpySphere.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"

namespace pm::benchmarking {
namespace {

void paintFrontOutside(benchmark::State& state) {
  const SurfaceModel& model = bumpySphere(42000);
  OctreeDecomposeOptions options;
  options.featureSize = std::ldexp(4, -static_cast<int>(state.range(0)));  // divides the domain evenly
  options.surfaceSize = options.featureSize;
  options.useDomain = true;
  options.domain = {Vec3::Constant(-2), Vec3::Constant(2)};
  options.refineEdges = false;
  PaintFrontOptions front;
  front.region = Region::Outside;
  Monitor monitor;
  const Octree tree = decompose(model, options, monitor);
  double cells = 0;
  for (auto _ : state) cells = paintFront(tree, model, front, monitor).cellCount;
  state.counters["leaves"] = tree.size();
  state.counters["cells"] = cells;
}
BENCHMARK(paintFrontOutside)
    ->ArgName("level")
    ->DenseRange(7, 10)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace pm::benchmarking
