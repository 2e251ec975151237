// SPDX-License-Identifier: BSD-3-Clause
#include "KeyIndex.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace pm {
namespace {

constexpr int kKeysPerBlockBits = 4;
constexpr int kMostBlockBits = 26;

/// Smallest number of bits that can tell `count` things apart.
int bitsFor(Key count) {
  int bits = 0;
  while (bits < 63 && (Key(1) << bits) < count) ++bits;
  return bits;
}

}  // namespace

void KeyIndex::build(const std::vector<Key>& keys) {
  const Id n = static_cast<Id>(keys.size());
  const int keyBits = keys.empty() ? 1 : bitsFor(keys.back() + 1);
  const int blockBits = std::clamp(bitsFor(n) - kKeysPerBlockBits, 0, std::min(kMostBlockBits, keyBits));
  blockShift_ = std::min(63, keyBits - blockBits);
  blockMask_ = (Key(1) << blockShift_) - 1;
  const std::size_t blockCount = keys.empty() ? 1 : (keys.back() >> blockShift_) + 1;
  const auto firstKeyOf = [&](std::size_t block) {
    const Key start = Key(block) << blockShift_;
    return static_cast<Id>(std::lower_bound(keys.begin(), keys.end(), start) - keys.begin());
  };
  std::vector<Id> firstKey(blockCount + 1, n);
  const auto each = [&](const auto& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blockCount, 256), [&](const auto& range) {
      for (std::size_t b = range.begin(); b != range.end(); ++b) body(b);
    });
  };
  each([&](std::size_t b) { firstKey[b] = firstKeyOf(b); });
  blocks_.assign(blockCount, {});
  std::uint32_t parts = 0;
  for (std::size_t b = 0; b < blockCount; ++b) {
    const int bits = std::min(blockShift_, bitsFor(firstKey[b + 1] - firstKey[b]));
    blocks_[b].firstPart = parts;
    blocks_[b].partShift = static_cast<std::uint8_t>(blockShift_ - bits);
    parts += std::uint32_t(1) << bits;
  }
  parts_.assign(std::size_t(parts) + 1, n);
  each([&](std::size_t b) {
    const std::uint32_t end = b + 1 < blockCount ? blocks_[b + 1].firstPart : parts;
    Id place = firstKey[b];
    for (std::uint32_t part = blocks_[b].firstPart; part < end; ++part) {
      const Key start = Key(part - blocks_[b].firstPart) << blocks_[b].partShift;
      while (place < firstKey[b + 1] && (keys[place] & blockMask_) < start) ++place;
      parts_[part] = place;
    }
  });
}

}  // namespace pm
