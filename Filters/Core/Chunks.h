// SPDX-License-Identifier: BSD-3-Clause
// Long parallel loops that the user can stop.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>

#include "Monitor.h"

namespace pm {

/// Calls body(i) for i in [0, count), in parallel; the monitor is asked before each 131,072 of them.
template <class Body>
void forChunks(Id count, Monitor& monitor, double fraction, const char* pass, const Body& body) {
  constexpr Id kChunk = 1 << 17;
  for (Id first = 0; first < count; first += std::min(kChunk, count - first)) {
    monitor.check(fraction, pass);
    tbb::parallel_for(first, first + std::min(kChunk, count - first), body);
  }
}

}  // namespace pm
