// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decodable.h"

#include "image/hot_pixels.h"

namespace palpate::sensing {

cv::Mat decodable(const cv::Mat& image, std::optional<BayerPattern> bayer) {
  return bayer ? demosaic(without_hot_pixels(image), *bayer) : image;
}

}  // namespace palpate::sensing
