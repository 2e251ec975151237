#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the benchmarks, runs each five times, and makes Docs/Images/performance_*.png and the tables of
# Docs/Performance.md from the medians. Takes about four minutes on two quiet cores.
#
#   Testing/Benchmark/run.sh [RESULTS.json]    an existing file of results is only written and drawn again
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$root/build-benchmark
results=${1:-$build/results.json}

if [ ! -f "$results" ] || [ $# -eq 0 ]; then
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DPROJECTIONMESHER_BUILD_PLUGIN=OFF \
    -DPROJECTIONMESHER_BUILD_BENCHMARKS=ON > "$build.log"
  ninja -C "$build" CoreBenchmarks >> "$build.log"
  rm -f "$build.log"
  "$build/Testing/Benchmark/CoreBenchmarks" --benchmark_repetitions=5 \
    --benchmark_out="$results" --benchmark_out_format=json
fi
pvpython "$here/plot_performance.py" "$results" "$root/Docs"
