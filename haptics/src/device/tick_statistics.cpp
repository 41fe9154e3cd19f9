// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/tick_statistics.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate::haptics {
namespace {

constexpr int kBitsOfOctave = 6;  // 2^6 bins

/// Numbers below 64 have a bin each; above, each octave has 64.
std::size_t bin_of(std::uint64_t value) noexcept {
  const int shift = std::max(0, static_cast<int>(std::bit_width(value)) - 1 - kBitsOfOctave);
  return static_cast<std::size_t>(shift) * (std::size_t{1} << kBitsOfOctave) +
         static_cast<std::size_t>(value >> shift);
}

std::uint64_t end_of_bin(std::size_t bin) noexcept {
  constexpr std::size_t kSize = std::size_t{1} << kBitsOfOctave;
  if (bin < 2 * kSize) return bin;
  const std::size_t shift = bin / kSize - 1;
  return ((std::uint64_t{bin % kSize + kSize} + 1) << shift) - 1;
}

}  // namespace

void DurationHistogram::add(std::uint64_t nanoseconds) noexcept {
  static_assert(kBinsOfOctave == 1 << kBitsOfOctave);
  ++bins_[std::min(bin_of(nanoseconds), bins_.size() - 1)];
  ++count_;
  largest_ = std::max(largest_, nanoseconds);
}

std::uint64_t DurationHistogram::quantile(double part) const noexcept {
  const auto rank = static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(count_)));
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    below += bins_[bin];
    if (below >= std::max<std::uint64_t>(rank, 1)) return std::min(end_of_bin(bin), largest_);
  }
  return largest_;
}

}  // namespace palpate::haptics
