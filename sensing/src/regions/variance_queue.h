// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace palpate::sensing {

/// Priority queue of pixels by the rank of their variance, first in first out within a rank; serves
/// a quality-guided flood in constant time. Keeps its memory.
class VarianceQueue {
 public:
  static constexpr int kRanks = 128;

  void reset() {
    lowest_ = kRanks;
    for (Rank& pixels : ranks_) {
      pixels.all.clear();
      pixels.served = 0;
    }
  }
  /// `rank` in 0 ... kRanks - 1
  void push(int pixel, int rank) {
    ranks_[static_cast<std::size_t>(rank)].all.push_back(pixel);
    lowest_ = std::min(lowest_, rank);
  }
  /// The next pixel, or -1.
  int pop() {
    for (; lowest_ < kRanks; ++lowest_) {
      Rank& pixels = ranks_[static_cast<std::size_t>(lowest_)];
      if (pixels.served < pixels.all.size()) return pixels.all[pixels.served++];
      pixels.all.clear();
      pixels.served = 0;
    }
    return -1;
  }

 private:
  struct Rank {
    std::vector<int> all;
    std::size_t served = 0;
  };
  int lowest_ = kRanks;
  std::array<Rank, kRanks> ranks_;
};

}  // namespace palpate::sensing
