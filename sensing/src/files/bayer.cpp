// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/bayer.h"

#include <opencv2/imgproc.hpp>
#include <string>

#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

int conversion(BayerPattern pattern) {
  switch (pattern) {
    case BayerPattern::rggb:
      return cv::COLOR_BayerBG2BGR;
    case BayerPattern::bggr:
      return cv::COLOR_BayerRG2BGR;
    case BayerPattern::grbg:
      return cv::COLOR_BayerGB2BGR;
    case BayerPattern::gbrg:
      return cv::COLOR_BayerGR2BGR;
  }
  throw InvalidInput("demosaic: the Bayer pattern is none of rggb, bggr, grbg, gbrg");
}

}  // namespace

BayerPattern bayer_pattern(std::string_view name) {
  if (name == "rggb") return BayerPattern::rggb;
  if (name == "bggr") return BayerPattern::bggr;
  if (name == "grbg") return BayerPattern::grbg;
  if (name == "gbrg") return BayerPattern::gbrg;
  throw InvalidInput("Bayer pattern \"" + std::string(name) +
                     "\" is not known; rggb, bggr, grbg and gbrg are");
}

cv::Mat demosaic(const cv::Mat& mosaic, BayerPattern pattern) {
  constexpr int kLeastSize = 3;  // px: a neighbour of each colour
  if (mosaic.channels() != 1) {
    throw InvalidInput("has " + std::to_string(mosaic.channels()) +
                       " channels; a Bayer mosaic has one. Leave the Bayer pattern out for an "
                       "image that is in colour already");
  }
  if (mosaic.depth() != CV_8U && mosaic.depth() != CV_16U)
    throw InvalidInput("a Bayer mosaic has 8 or 16 bit");
  if (mosaic.cols < kLeastSize || mosaic.rows < kLeastSize) {
    throw InvalidInput("is " + std::to_string(mosaic.cols) + " x " + std::to_string(mosaic.rows) +
                       " px; a Bayer mosaic has at least 3 x 3");
  }
  cv::Mat image;
  cv::cvtColor(mosaic, image, conversion(pattern));
  return image;
}

}  // namespace palpate::sensing
