// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/lit_channels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::sensing {
namespace {

/// Side of a block [px], and blocks along a column that are searched on either side.
constexpr long kModulationBlock = 16;
constexpr long kModulationBlocksAlong = 1;

/// Least half amplitude of a channel that a surface reflects, and its least part of the strongest
/// channel's: less is crosstalk.
constexpr float kLeastModulation = 0.004F;
constexpr float kLeastPart = 0.015F;
/// The others' part if a surface reflects hardly more than one channel.
constexpr float kOthersPart = 0.1F;

}  // namespace

LargestModulation::LargestModulation(long rows, long columns, double across)
    : rows_((rows + kModulationBlock - 1) / kModulationBlock),
      columns_((columns + kModulationBlock - 1) / kModulationBlock),
      across_(static_cast<long>(std::ceil(across / kModulationBlock))),
      blocks_(static_cast<std::size_t>(rows_ * columns_)) {}

std::size_t LargestModulation::block_of(long row, long column) const {
  return static_cast<std::size_t>(row / kModulationBlock * columns_ + column / kModulationBlock);
}

void LargestModulation::add(long row, long column, const std::vector<Demodulated>& channels) {
  Powers& block = blocks_[block_of(row, column)];
  for (std::size_t c = 0; c < kColorChannels; ++c) {
    block[c] = std::max(block[c], channels[c].power(row, column));
  }
}

void LargestModulation::finish() {
  const auto raise = [](const Powers& to, Powers& values) {
    for (std::size_t c = 0; c < kColorChannels; ++c) values[c] = std::max(values[c], to[c]);
  };
  Powers most{};
  for (const Powers& block : blocks_) raise(block, most);
  const float strongest = *std::max_element(most.begin(), most.end());
  const float least =
      std::max(kLeastModulation * kLeastModulation, kLeastPart * kLeastPart * strongest);
  reflected_ = 0;
  single_ = std::count_if(most.begin(), most.end(), [&](float power) {
              return power > kOthersPart * kOthersPart * strongest;
            }) == 1;
  for (std::size_t c = 0; c < kColorChannels; ++c) {
    if (most[c] >= least) reflected_ |= static_cast<std::uint8_t>(1U << c);
  }
  std::vector<Powers> around(blocks_.size());
  for (long row = 0; row < rows_; ++row) {
    const long bottom = std::min(rows_ - 1, row + kModulationBlocksAlong);
    for (long column = 0; column < columns_; ++column) {
      Powers& largest = around[static_cast<std::size_t>(row * columns_ + column)];
      const long right = std::min(columns_ - 1, column + across_);
      for (long r = std::max(0L, row - kModulationBlocksAlong); r <= bottom; ++r) {
        for (long c = std::max(0L, column - across_); c <= right; ++c) {
          raise(blocks_[static_cast<std::size_t>(r * columns_ + c)], largest);
        }
      }
    }
  }
  blocks_ = std::move(around);
}

std::uint8_t LargestModulation::lit(long row, long column,
                                    const std::vector<Demodulated>& channels) const {
  const Powers& most = blocks_[block_of(row, column)];
  Powers share{};
  float largest = 0;
  for (std::size_t c = 0; c < kColorChannels; ++c) {
    if ((reflected_ >> c & 1U) == 0 || !(most[c] > 0)) continue;
    share[c] = channels[c].power(row, column) / most[c];
    largest = std::max(largest, share[c]);
  }
  if (largest < kDark * kDark) return 0;
  std::uint8_t lit = 0;
  for (std::size_t c = 0; c < kColorChannels; ++c) {
    if (share[c] >= kLit * kLit * largest) lit |= static_cast<std::uint8_t>(1U << c);
  }
  return lit & reflected_;
}

}  // namespace palpate::sensing
