// SPDX-License-Identifier: BSD-3-Clause
// A growing array that never moves its items: no copies and no second array while it grows.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace pm {

template <class T>
class ChunkedArray {
 public:
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return chunks_[i >> kBits][i & kMask]; }
  const T& operator[](std::size_t i) const { return chunks_[i >> kBits][i & kMask]; }
  /// Grows to `size` items; new ones are value-initialised.
  void grow(std::size_t size) {
    while (chunks_.size() << kBits < size) chunks_.push_back(std::make_unique<T[]>(std::size_t(1) << kBits));
    size_ = size;
  }
  void clear() {
    chunks_.clear();
    size_ = 0;
  }

 private:
  static constexpr int kBits = 14;
  static constexpr std::size_t kMask = (std::size_t(1) << kBits) - 1;

  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace pm
