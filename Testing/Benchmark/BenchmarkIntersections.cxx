// SPDX-License-Identifier: BSD-3-Clause
// Where the triangles of a soup cut each other, all of them found up front.
#include <benchmark/benchmark.h>

#include "BumpySphere.h"
#include "SelfIntersections.h"

namespace pm::benchmarking {
namespace {

/// Two bumpy spheres of half the triangles each, the second shifted by its radius: they cut along a closed
/// curve.
std::unique_ptr<SurfaceModel> crossingSpheres(Id triangles) {
  const SurfaceModel& sphere = bumpySphere(triangles / 2);
  const Id points = static_cast<Id>(sphere.points().size());
  std::vector<Vec3> places = sphere.points();
  std::vector<SurfaceModel::Triangle> rows = sphere.triangles();
  for (Id p = 0; p < points; ++p) places.push_back(sphere.points()[p] + Vec3(1, 0.1, 0.2));
  for (const SurfaceModel::Triangle& t : sphere.triangles())
    rows.push_back({t[0] + points, t[1] + points, t[2] + points});
  return std::make_unique<SurfaceModel>(places, rows, std::vector<Id>(rows.size(), 0),
                                        std::vector<std::string>{"spheres"});
}

void selfIntersectionCurves(benchmark::State& state) {
  const std::unique_ptr<SurfaceModel> model = crossingSpheres(static_cast<Id>(state.range(0)));
  SelfIntersections found;
  for (auto _ : state) {
    Monitor monitor;
    found = selfIntersections(*model, monitor);
  }
  state.counters["triangles"] = double(model->triangles().size());
  state.counters["segments"] = double(found.segments.size());
}
BENCHMARK(selfIntersectionCurves)
    ->ArgNames({"triangles"})
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace pm::benchmarking
