// SPDX-License-Identifier: BSD-3-Clause
// Exact closest points of models of 1e4 to 1.25e6 triangles, for points near the surface; one thread.
#include <benchmark/benchmark.h>

#include <random>

#include "BumpySphere.h"

namespace pm::benchmarking {
namespace {

std::vector<Vec3> pointsNearSphere() {
  std::mt19937_64 generator(1);
  const auto next = [&] { return 2 * (double(generator() >> 11) * 0x1p-53) - 1; };
  std::vector<Vec3> points(4096);
  for (Vec3& p : points) {
    do p = Vec3(next(), next(), next());
    while (p.squaredNorm() > 1 || p.squaredNorm() < 0.1);
    p *= (1 + 0.05 * next()) / p.norm();
  }
  return points;
}

void closestPoint(benchmark::State& state) {
  const SurfaceModel& model = bumpySphere(static_cast<Id>(state.range(0)));
  const std::vector<Vec3> points = pointsNearSphere();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(model.closest(points[i++ % points.size()]));
  state.counters["triangles"] = model.triangleCount();
}
BENCHMARK(closestPoint)->Arg(10000)->Arg(42000)->Arg(200000)->Arg(1250000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pm::benchmarking
