// SPDX-License-Identifier: BSD-3-Clause
#include "PolyMesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

/// Calls body(i) for i in [0, count), in parallel.
template <class Body>
void forEach(Id count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Id>(0, count, 1024), [&](const tbb::blocked_range<Id>& range) {
    for (Id i = range.begin(); i != range.end(); ++i) body(i);
  });
}

/// Counts in offsets[i + 1] become the starts of rows.
void prefixSum(std::vector<Id>& offsets) {
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
}

/// Starts each face at its smallest point and turns internal faces to leave the smaller cell.
void orientFaces(PolyMesh& mesh) {
  const Id internal = mesh.internalFaces();
  forEach(mesh.faceCount(), [&](Id f) {
    const auto first = mesh.faces.values.begin() + mesh.faces.offsets[f];
    const auto last = mesh.faces.values.begin() + mesh.faces.offsets[f + 1];
    if (first == last) return;
    if (f < internal && mesh.owner[f] > mesh.neighbour[f]) {
      std::swap(mesh.owner[f], mesh.neighbour[f]);
      std::reverse(first, last);
    }
    std::rotate(first, std::min_element(first, last), last);
  });
}

/// Sorts order[first, last) by owner, then by `less`; a bucket for each owner keeps it linear.
template <class Less>
void sortByOwner(const PolyMesh& mesh, Id first, Id last, std::vector<Id>& order, const Less& less) {
  std::vector<Id> start(static_cast<std::size_t>(mesh.cellCount) + 1, 0);
  for (Id f = first; f < last; ++f) ++start[mesh.owner[f] + 1];
  start[0] = first;
  prefixSum(start);
  std::vector<Id> next(start.begin(), start.end() - 1);
  for (Id f = first; f < last; ++f) order[next[mesh.owner[f]]++] = f;
  forEach(mesh.cellCount,
          [&](Id c) { std::sort(order.begin() + start[c], order.begin() + start[c + 1], less); });
}

/// Old ids of the faces in canonical order.
std::vector<Id> canonicalOrder(const PolyMesh& mesh) {
  std::vector<Id> order(mesh.faceCount());
  const auto byPoints = [&](Id a, Id b) {
    const Span<Id> x = mesh.faces[a], y = mesh.faces[b];
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  const Id internal = mesh.internalFaces();
  sortByOwner(mesh, 0, internal, order, [&](Id a, Id b) {
    return mesh.neighbour[a] != mesh.neighbour[b] ? mesh.neighbour[a] < mesh.neighbour[b] : byPoints(a, b);
  });
  sortByOwner(mesh, internal, mesh.faceCount(), order, byPoints);
  return order;
}

/// Faces that change places only among themselves.
struct Run {
  Id first, last;
};

/// The runs of an order, those of one face left out. Faces that come by cells are out of order within a cell
/// alone: most runs are short, and what is set aside to permute them is little.
std::vector<Run> movedRuns(const std::vector<Id>& order) {
  std::vector<Run> runs;
  Id first = 0, most = -1;
  for (Id i = 0; i < static_cast<Id>(order.size()); ++i) {
    most = std::max(most, order[i]);
    if (most > i) continue;
    if (first < i) runs.push_back({first, i + 1});
    first = i + 1;
  }
  return runs;
}

template <class Body>
void forEachRun(const std::vector<Run>& runs, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, runs.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(runs[i]);
  });
}

/// values[i - shift] = old values[order[i] - shift] for the faces that `values` has.
void permute(std::vector<Id>& values, const std::vector<Id>& order, const std::vector<Run>& runs, Id shift) {
  forEachRun(runs, [&](const Run& run) {
    if (run.first < shift || run.last - shift > static_cast<Id>(values.size())) return;
    std::vector<Id> moved(run.last - run.first);
    for (Id i = run.first; i < run.last; ++i) moved[i - run.first] = values[order[i] - shift];
    std::copy(moved.begin(), moved.end(), values.begin() + (run.first - shift));
  });
}

void permuteRows(Csr<Id>& rows, const std::vector<Id>& order, const std::vector<Run>& runs) {
  forEachRun(runs, [&](const Run& run) {
    const Id start = rows.offsets[run.first];
    std::vector<Id> values, ends;
    values.reserve(rows.offsets[run.last] - start);
    ends.reserve(run.last - run.first);
    for (Id i = run.first; i < run.last; ++i) {
      const Span<Id> row = rows[order[i]];
      values.insert(values.end(), row.begin(), row.end());
      ends.push_back(start + static_cast<Id>(values.size()));
    }
    std::copy(values.begin(), values.end(), rows.values.begin() + start);
    std::copy(ends.begin(), ends.end(), rows.offsets.begin() + run.first + 1);
  });
}

}  // namespace

void canonicalise(PolyMesh& mesh) {
  orientFaces(mesh);
  const std::vector<Id> order = canonicalOrder(mesh);
  const std::vector<Run> runs = movedRuns(order);
  permuteRows(mesh.faces, order, runs);
  permute(mesh.owner, order, runs, 0);
  permute(mesh.neighbour, order, runs, 0);
  permute(mesh.patch, order, runs, mesh.internalFaces());
}

Csr<Id> cellFaces(const PolyMesh& mesh) {
  Csr<Id> rows;
  rows.offsets.assign(static_cast<std::size_t>(mesh.cellCount) + 1, 0);
  for (Id c : mesh.owner) ++rows.offsets[c + 1];
  for (Id c : mesh.neighbour) ++rows.offsets[c + 1];
  prefixSum(rows.offsets);
  rows.values.resize(rows.offsets.back());
  std::vector<Id> next(rows.offsets.begin(), rows.offsets.end() - 1);
  const Id internal = mesh.internalFaces();
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    rows.values[next[mesh.owner[f]]++] = f;
    if (f < internal) rows.values[next[mesh.neighbour[f]]++] = f;
  }
  return rows;
}

Csr<Id> pointCells(const PolyMesh& mesh, const Csr<Id>& facesOfCell) {
  const auto forEachPointOnce = [&](const auto& body) {
    std::vector<Id> seen(mesh.points.size(), kNone);
    for (Id c = 0; c < mesh.cellCount; ++c) {
      for (Id f : facesOfCell[c]) {
        for (Id p : mesh.faces[f]) {
          if (seen[p] == c) continue;
          seen[p] = c;
          body(p, c);
        }
      }
    }
  };
  Csr<Id> rows;
  rows.offsets.assign(mesh.points.size() + 1, 0);
  forEachPointOnce([&](Id p, Id) { ++rows.offsets[p + 1]; });
  prefixSum(rows.offsets);
  rows.values.resize(rows.offsets.back());
  std::vector<Id> next(rows.offsets.begin(), rows.offsets.end() - 1);
  forEachPointOnce([&](Id p, Id c) { rows.values[next[p]++] = c; });
  return rows;
}

Csr<Id> pointFaces(const PolyMesh& mesh) {
  Csr<Id> rows;
  rows.offsets.assign(mesh.points.size() + 1, 0);
  for (Id p : mesh.faces.values) ++rows.offsets[p + 1];
  prefixSum(rows.offsets);
  rows.values.resize(rows.offsets.back());
  std::vector<Id> next(rows.offsets.begin(), rows.offsets.end() - 1);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    for (Id p : mesh.faces[f]) rows.values[next[p]++] = f;
  }
  return rows;
}

}  // namespace pm
