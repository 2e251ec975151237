// SPDX-License-Identifier: BSD-3-Clause
// Constant-time search in a sorted array of Morton keys, however unevenly the keys are spread.
//
// The range of keys is cut into equal blocks, about one for every 16 keys, and each block into equal parts,
// about one for each of its own keys. A query reads one block, one part and the one or two keys in it. The
// index takes 4 to 9 bytes a key; it does not hold the keys, so it stays valid when they are copied or moved.
#pragma once

#include <vector>

#include "Types.h"

namespace pm {

using Key = std::uint64_t;

class KeyIndex {
 public:
  void build(const std::vector<Key>& keys);

  /// How many of `keys` (those of build()) are not above `key`; the last of them is at the place before.
  Id upperBound(const std::vector<Key>& keys, Key key) const {
    const Key b = key >> blockShift_;
    if (b >= blocks_.size()) return static_cast<Id>(keys.size());
    const Block& block = blocks_[b];
    const std::size_t part = block.firstPart + ((key & blockMask_) >> block.partShift);
    Id i = parts_[part], end = parts_[part + 1];
    while (end - i > kScan) {
      const Id middle = i + (end - i) / 2;
      (keys[middle] <= key ? i : end) = middle;
    }
    while (i < end && keys[i] <= key) ++i;
    return i;
  }
  /// Place of `key` in the array, kNone when it is not there.
  Id find(const std::vector<Key>& keys, Key key) const {
    const Id place = upperBound(keys, key) - 1;
    return place >= 0 && keys[place] == key ? place : kNone;
  }

 private:
  struct Block {
    std::uint32_t firstPart = 0;
    std::uint8_t partShift = 0;
  };
  static constexpr Id kScan = 8;

  std::vector<Block> blocks_;
  std::vector<Id> parts_;  // place of the first key not below the part
  int blockShift_ = 63;
  Key blockMask_ = 0;
};

}  // namespace pm
