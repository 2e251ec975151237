// SPDX-License-Identifier: BSD-3-Clause
// The few types every part of the kernel shares: ids, points, boxes, row lists and the errors a user may see.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace pm {

using Vec3 = Eigen::Vector3d;
using Id = std::int32_t;
constexpr Id kNone = -1;

/// Base of all errors the kernel throws; what() is a sentence for the user: what is wrong and what to do.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct InputError : Error {
  using Error::Error;
};  ///< geometry or an option cannot be used
struct RegionError : Error {
  using Error::Error;
};  ///< nothing to mesh, or the chosen region leaks
struct BudgetError : Error {
  using Error::Error;
};  ///< the estimate exceeds the cell budget
struct AbortError : Error {
  using Error::Error;
};  ///< the user asked to stop
struct InternalError : Error {
  using Error::Error;
};  ///< a promise of the kernel was broken; a bug

/// Axis-aligned box; empty (lo > hi) until a point is added.
struct Box {
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 hi = Vec3::Constant(-std::numeric_limits<double>::infinity());
  void add(const Vec3& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  bool empty() const { return !(lo.array() <= hi.array()).all(); }
  Vec3 size() const { return hi - lo; }
  Vec3 centre() const { return 0.5 * (lo + hi); }
  double diagonal() const { return empty() ? 0.0 : size().norm(); }
  bool contains(const Vec3& p) const {
    return (p.array() >= lo.array()).all() && (p.array() <= hi.array()).all();
  }
  bool overlaps(const Box& b) const {
    return (lo.array() <= b.hi.array()).all() && (b.lo.array() <= hi.array()).all();
  }
  double distance2(const Vec3& p) const { return (lo - p).cwiseMax(p - hi).cwiseMax(0.0).squaredNorm(); }
};

/// Ascending, each value once.
template <class T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// A read-only run of consecutive values, one row of a Csr.
template <class T>
struct Span {
  const T* first = nullptr;
  const T* last = nullptr;
  const T* begin() const { return first; }
  const T* end() const { return last; }
  std::size_t size() const { return static_cast<std::size_t>(last - first); }
  bool empty() const { return first == last; }
  const T& operator[](std::size_t i) const { return first[i]; }
};
template <class T>
Span<T> spanOf(const std::vector<T>& values) {
  return {values.data(), values.data() + values.size()};
}

/// Rows of different length in two flat arrays (compressed sparse rows): row i is values[offsets[i] ..
/// offsets[i+1]).
template <class T>
struct Csr {
  std::vector<Id> offsets{0};
  std::vector<T> values;
  Id rows() const { return static_cast<Id>(offsets.size()) - 1; }
  Span<T> operator[](Id i) const { return {values.data() + offsets[i], values.data() + offsets[i + 1]}; }
  void clear() {
    offsets.assign(1, 0);
    values.clear();
  }
  template <class Row>
  void push(const Row& row) {
    values.insert(values.end(), std::begin(row), std::end(row));
    offsets.push_back(static_cast<Id>(values.size()));
  }
};

}  // namespace pm
