// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decodable.h"

#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "image/hot_pixels.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

cv::Mat stretched(const cv::Mat& image, int bits) {
  if (image.depth() != CV_16U) return image;
  const int most = (1 << bits) - 1;
  const double largest = cv::norm(image, cv::NORM_INF);
  if (largest > most) {
    throw InvalidInput(fmt::format("holds the value {}; with {} bits at most {} is expected",
                                   largest, bits, most));
  }
  cv::Mat wide;
  image.convertTo(wide, CV_16U, full_scale(image) / most);
  return wide;
}

}  // namespace

cv::Mat decodable(const cv::Mat& image, std::optional<BayerPattern> bayer, int bits) {
  require("decodable(): bits", bits, at_least(8).at_most(16));
  // Hot pixels are defined relative to full scale, so the values are stretched first.
  const cv::Mat wide = bits < 16 ? stretched(image, bits) : image;
  return bayer ? demosaic(without_hot_pixels(wide), *bayer) : wide;
}

}  // namespace palpate::sensing
