// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/hot_pixels.h"

#include <array>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Pixels of one colour lie this far apart [px].
constexpr int kMosaicSpacing = 2;
/// A pixel stands out if it is beyond all eight neighbours by more than this share of full scale,
/// which the noise of a usable camera hardly reaches. The crest of a sinusoid at the edge of a
/// stripe has a single neighbour that is like it.
constexpr float kLeastExcess = 0.03F;

/// The pixel, or if it stands out, the mean of those opposite neighbours that differ least: along
/// the sinusoid's crests and the edges of stripes, not across.
template <typename T>
[[gnu::always_inline]] inline T repaired(const std::array<const T*, 3>& rows, long i) {
  constexpr float least = kLeastExcess * static_cast<float>(std::numeric_limits<T>::max());
  constexpr std::array<std::array<int, 2>, 4> kHalves = {{{0, -1}, {0, 0}, {0, 1}, {1, -1}}};
  float high = 0;
  float low = std::numeric_limits<T>::max();
  float closest = std::numeric_limits<float>::max();
  float usual = 0;
  for (const auto& [row, side] : kHalves) {
    const auto first =
        static_cast<float>(rows[static_cast<std::size_t>(row)][i + side * kMosaicSpacing]);
    const auto second =
        static_cast<float>(rows[static_cast<std::size_t>(2 - row)][i - side * kMosaicSpacing]);
    const float upper = first > second ? first : second;
    const float lower = first > second ? second : first;
    high = upper > high ? upper : high;
    low = lower < low ? lower : low;
    const bool closer = upper - lower < closest;
    usual = closer ? 0.5F * (first + second) : usual;
    closest = closer ? upper - lower : closest;
  }
  const auto own = static_cast<float>(rows[1][i]);
  const bool stands_out = own > high + least || own < low - least;
  return stands_out ? static_cast<T>(usual + 0.5F) : rows[1][i];
}

PALPATE_HOT_LOOP void repair_row(const std::array<const std::uint8_t*, 3>& rows, long columns,
                                 std::uint8_t* __restrict out) {
  for (long i = 0; i < columns; ++i) out[i] = repaired<std::uint8_t>(rows, i);
}

PALPATE_HOT_LOOP void repair_row(const std::array<const std::uint16_t*, 3>& rows, long columns,
                                 std::uint16_t* __restrict out) {
  for (long i = 0; i < columns; ++i) out[i] = repaired<std::uint16_t>(rows, i);
}

template <typename T>
void repair(const cv::Mat& padded, cv::Mat& image) {
  for (int row = 0; row < image.rows; ++row) {
    const std::array<const T*, 3> rows = {padded.ptr<T>(row) + kMosaicSpacing,
                                          padded.ptr<T>(row + kMosaicSpacing) + kMosaicSpacing,
                                          padded.ptr<T>(row + 2 * kMosaicSpacing) + kMosaicSpacing};
    repair_row(rows, image.cols, image.ptr<T>(row));
  }
}

}  // namespace

cv::Mat without_hot_pixels(const cv::Mat& mosaic) {
  const bool is_mosaic = (mosaic.type() == CV_8UC1 || mosaic.type() == CV_16UC1) &&
                         mosaic.cols > kMosaicSpacing && mosaic.rows > kMosaicSpacing;
  if (!is_mosaic) return mosaic;
  // Mirroring at the outermost pixels keeps the order of the colours.
  cv::Mat padded;
  cv::copyMakeBorder(mosaic, padded, kMosaicSpacing, kMosaicSpacing, kMosaicSpacing, kMosaicSpacing,
                     cv::BORDER_REFLECT_101);
  cv::Mat image(mosaic.size(), mosaic.type());
  if (mosaic.depth() == CV_8U) {
    repair<std::uint8_t>(padded, image);
  } else {
    repair<std::uint16_t>(padded, image);
  }
  return image;
}

}  // namespace palpate::sensing
