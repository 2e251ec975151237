// SPDX-License-Identifier: BSD-3-Clause
// Rows of ids that are gathered, sorted and thinned in parallel.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "Types.h"

namespace pm {

/// gather(i, ids) puts the ids of row i, in any order and any number of times, at the end of `ids`, which is
/// empty; it is asked twice, from any thread. Each row ascends and holds each id once.
template <class Gather>
Csr<Id> sortedRows(Id count, const Gather& gather) {
  const auto forEachRow = [&](const auto& body) {
    tbb::parallel_for(tbb::blocked_range<Id>(0, count, 1024), [&](const auto& range) {
      std::vector<Id> ids;
      for (Id i = range.begin(); i < range.end(); ++i) {
        ids.clear();
        gather(i, ids);
        sortUnique(ids);
        body(i, ids);
      }
    });
  };
  Csr<Id> rows;
  rows.offsets.assign(static_cast<std::size_t>(count) + 1, 0);
  forEachRow([&](Id i, const auto& ids) { rows.offsets[i + 1] = static_cast<Id>(ids.size()); });
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.values.resize(rows.offsets.back());
  forEachRow([&](Id i, const auto& ids) {
    std::copy(ids.begin(), ids.end(), rows.values.begin() + rows.offsets[i]);
  });
  return rows;
}

}  // namespace pm
