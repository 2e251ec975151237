// SPDX-License-Identifier: BSD-3-Clause
// Localisation (thesis 3.3): the lists of the triangles in each leaf, nothing else.
#include <benchmark/benchmark.h>

#include <cmath>

#include "BumpySphere.h"
#include "OctreeBuilder.h"

namespace pm::benchmarking {
namespace {

/// Splits every cell that a triangle touches down to the finest level.
OctreeBuilder localise(const SurfaceModel& model, const Brick& brick) {
  OctreeBuilder builder(brick, model);
  Id first = 0;
  for (int level = 0; level < brick.maxLevel; ++level) {
    std::vector<Id> cut;
    const Id end = builder.size();
    for (Id i = first; i < end; ++i)
      if (builder.node(i).isCut()) cut.push_back(i);
    builder.split(cut);
    first = end;
  }
  return builder;
}

/// 2^boxBits boxes along each side of a cube around the model, finest cells of the given edge.
Brick brickOf(const SurfaceModel& model, int boxBits, double finest) {
  const double extent = model.bounds().size().maxCoeff() * 1.02;
  const int bits = static_cast<int>(std::ceil(std::log2(extent / finest)));
  Brick brick;
  brick.roots = {1 << boxBits, 1 << boxBits, 1 << boxBits};
  brick.maxLevel = bits - boxBits;
  const double edge = std::ldexp(finest, bits);
  brick.rootSize = Vec3::Constant(edge / double(1 << boxBits));
  brick.origin = model.bounds().centre() - Vec3::Constant(0.5 * edge);
  return brick;
}

void run(benchmark::State& state, Id triangles, int boxBits, double finest) {
  const SurfaceModel& model = bumpySphere(triangles);
  double leaves = 0, entries = 0;
  for (auto _ : state) {
    const OctreeBuilder builder = localise(model, brickOf(model, boxBits, finest));
    leaves = builder.leafCount();
    state.PauseTiming();
    entries = 0;
    for (Id i = 0; i < builder.size(); ++i) entries += double(builder.triangles(builder.node(i)).size());
    state.ResumeTiming();
  }
  state.counters["leaves"] = leaves;
  state.counters["list_entries"] = entries;
}

// Finest cells of a triangle's edge divided by the first argument; 2^second boxes along a side.
void localisationOfLargeModel(benchmark::State& state) {
  constexpr Id kTriangles = 1250000;
  run(state, kTriangles, static_cast<int>(state.range(1)), triangleEdge(kTriangles) / double(state.range(0)));
}
BENCHMARK(localisationOfLargeModel)
    ->ArgNames({"finer", "boxBits"})
    ->ArgsProduct({{1, 4}, {0, 6}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1);

// Counterpart of Fig. 3-11: time against leaves for different numbers of boxes; about the wanted leaves.
void localisationFigure311(benchmark::State& state) {
  run(state, 42000, static_cast<int>(state.range(1)), 6.75 / std::sqrt(double(state.range(0))));
}
BENCHMARK(localisationFigure311)
    ->ArgNames({"leaves", "boxBits"})
    ->ArgsProduct({{100000, 200000, 300000, 400000, 500000, 600000, 700000}, {0, 4, 5, 6}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace pm::benchmarking
