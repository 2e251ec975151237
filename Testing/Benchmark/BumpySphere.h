// SPDX-License-Identifier: BSD-3-Clause
// The benchmarks' geometry: a sphere of radius 1 with bumps, of any number of triangles of about one size.
#pragma once

#include <memory>

#include "SurfaceModel.h"

namespace pm::benchmarking {

/// Made once for each size and kept. A cube's six sides, n by n squares each, blown up: 12 n^2 triangles,
/// n = sqrt(triangles / 12) rounded.
const SurfaceModel& bumpySphere(Id triangles);
/// Mean edge of its triangles.
double triangleEdge(Id triangles);

}  // namespace pm::benchmarking
