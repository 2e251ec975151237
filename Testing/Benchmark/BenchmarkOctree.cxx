// SPDX-License-Identifier: BSD-3-Clause
// Growth of the octree: seconds and bytes a leaf from 1e5 to 1e7 leaves, refinement by a size on the surface.
#include <benchmark/benchmark.h>

#include <cmath>

#include "BumpySphere.h"
#include "MemoryCount.h"
#include "OctreeDecompose.h"

namespace pm::benchmarking {
namespace {

constexpr Id kTriangles = 42000;

OctreeDecomposeOptions bySurfaceSize(double leaves) {
  OctreeDecomposeOptions o;
  o.featureSize = 10.2 / std::sqrt(leaves);  // leaves grow with the square of what the size shrinks by
  o.surfaceSize = o.featureSize;
  o.normalAngle = 0;
  o.refineEdges = false;
  o.separate = false;
  return o;
}

void octreeLeaves(benchmark::State& state) {
  const SurfaceModel& model = bumpySphere(kTriangles);
  Monitor monitor;
  const std::size_t before = bytesHeld();
  double leaves = 0, lists = 0;
  forgetPeak();
  for (auto _ : state) {
    const Octree tree = decompose(model, bySurfaceSize(double(state.range(0))), monitor);
    leaves = tree.size();
    lists = double(tree.triangles.values.size()) * sizeof(Id);
  }
  state.counters["leaves"] = leaves;
  state.counters["bytes_per_leaf"] = (double(peakBytes() - before) - lists) / leaves;
  state.counters["list_bytes_per_leaf"] = lists / leaves;
}

BENCHMARK(octreeLeaves)
    ->Arg(100000)
    ->Arg(316000)
    ->Arg(1000000)
    ->Arg(3160000)
    ->Arg(10000000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace pm::benchmarking
