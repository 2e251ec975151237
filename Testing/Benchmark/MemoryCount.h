// SPDX-License-Identifier: BSD-3-Clause
// Bytes held from operator new, now and at most: what a benchmark's memory per leaf is computed from.
#pragma once

#include <cstddef>

namespace pm::benchmarking {

std::size_t bytesHeld();
/// The most bytes held since the last call of forgetPeak().
std::size_t peakBytes();
void forgetPeak();

}  // namespace pm::benchmarking
