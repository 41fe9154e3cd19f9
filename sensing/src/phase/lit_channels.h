// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Channels of a frame with stripes: green, red, blue. A set of them has bit c for channel c.
inline constexpr std::size_t kColorChannels = 3;

/// The largest modulation of each channel around each place of a surface: the one that its colour
/// and the light there give where a stripe has the channel.
class LargestModulation {
 public:
  /// A pixel is dark if every channel has less than this share of the largest modulation that the
  /// surface around shows in it; ...
  static constexpr float kDark = 0.25F;
  /// ... a channel of another pixel is lit if its share is this part of the pixel's largest one.
  static constexpr float kLit = 0.45F;

  /// \param rows, columns of the image.
  /// \param across [px] distance to each side along a row in which the surface is searched: so
  /// large that every channel is in some stripe. Along a column it is a block, 16 px.
  LargestModulation(long rows, long columns, double across);

  /// Adds a pixel of the surface.
  void add(long row, long column, const std::vector<Demodulated>& channels);

  /// Call after the last pixel. Finds the channels that the surface reflects: those with at least
  /// 0.4 % of full scale and 1.5 % of the strongest channel.
  void finish();
  [[nodiscard]] std::uint8_t reflected() const { return reflected_; }
  /// Returns true if one channel is at least ten times as strong as the others.
  [[nodiscard]] bool single() const { return single_; }

  /// The channels that are lit at a pixel of the surface, out of those that it reflects.
  [[nodiscard]] std::uint8_t lit(long row, long column,
                                 const std::vector<Demodulated>& channels) const;

 private:
  using Powers = std::array<float, kColorChannels>;  ///< squares of half amplitudes
  [[nodiscard]] std::size_t block_of(long row, long column) const;

  long rows_ = 0;  ///< of blocks
  long columns_ = 0;
  long across_ = 0;
  std::vector<Powers> blocks_;
  std::uint8_t reflected_ = 0;
  bool single_ = false;
};

}  // namespace palpate::sensing
