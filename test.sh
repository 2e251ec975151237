#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets up, builds and runs every test: the plugin's and the kernel's, then the kernel's again under AddressSanitizer and
# UndefinedBehaviorSanitizer. Arguments go to the first ctest (e.g. -R Octree). Exits non-zero on any failure.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/.ci/setup.sh"

setup_packages
setup_build "$root/build" -DCMAKE_BUILD_TYPE=Release
# Little optimisation: full optimisation of instrumented code takes more time to compile than it saves in the tests.
setup_build "$root/build-sanitize" -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" \
  -DPROJECTIONMESHER_SANITIZE=ON -DPROJECTIONMESHER_BUILD_PLUGIN=OFF

failed=0
jobs=$(nproc)
say "Tests of the kernel under the sanitizers:"
ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1 \
  ctest --test-dir "$root/build-sanitize" --output-on-failure -j "$jobs" || failed=1
say "Tests of the plugin and the kernel:"
ctest --test-dir "$root/build" --output-on-failure -j "$jobs" "$@" || failed=1
exit $failed
