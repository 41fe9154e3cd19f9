// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/gray_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>

#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

constexpr int kLargestPanel = 1 << 15;  ///< px

void check_panel(const ImageSize& panel) {
  const Interval possible = at_least(2).at_most(kLargestPanel);
  require("Gray code: the projector's width", panel.width, possible, "px");
  require("Gray code: the projector's height", panel.height, possible, "px");
}

/// Number of bits of the coordinates 0 ... size - 1.
int bits_of(int size) { return std::bit_width(static_cast<unsigned>(size - 1)); }

void check_images(const std::vector<cv::Mat>& images, const ImageSize& panel) {
  const int expected = gray_code_length(panel);
  if (static_cast<int>(images.size()) != expected) {
    throw InvalidInput("Gray code: there are " + std::to_string(images.size()) +
                       " images; a projector of " + std::to_string(panel.width) + " x " +
                       std::to_string(panel.height) + " px shows " + std::to_string(expected));
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat& image = images[i];
    if (image.empty() || image.size() != images[0].size() || image.type() != images[0].type() ||
        (image.type() != CV_8UC1 && image.type() != CV_16UC1)) {
      throw InvalidInput("Gray code: image " + std::to_string(i) +
                         " is not of 8 or 16 bit with one channel, or differs from the first one "
                         "in size or type");
    }
  }
}

/// Adds one bit to the code of each pixel.
void append_bit(const cv::Mat& image, const cv::Mat& inverse, cv::Mat_<int>& codes) {
  const cv::Mat is_set = image > inverse;  // 0 or 255
  for (int row = 0; row < codes.rows; ++row) {
    const auto* bits = is_set.ptr<uchar>(row);
    int* code = codes[row];
    for (int column = 0; column < codes.cols; ++column)
      code[column] = 2 * code[column] + (bits[column] != 0 ? 1 : 0);
  }
}

/// Decodes one coordinate from the pairs of images that begin at `first`.
cv::Mat_<int> read_codes(const std::vector<cv::Mat>& images, std::size_t first, int bits) {
  cv::Mat_<int> codes(images[0].size(), 0);
  for (std::size_t bit = 0; bit < static_cast<std::size_t>(bits); ++bit)
    append_bit(images[first + 2 * bit], images[first + 2 * bit + 1], codes);
  return codes;
}

/// Codes beyond the panel come from misread bits, at up to 0.0001 % of the lit pixels of a real
/// capture, or from a panel whose width and height are exchanged, at 6 to 8 %.
constexpr double kMostBeyond = 0.02;

void check_beyond(long beyond, long lit, const ImageSize& panel) {
  const double share = static_cast<double>(beyond) / static_cast<double>(std::max(lit, 1L));
  if (share <= kMostBeyond) return;
  throw InvalidInput("Gray code: " + std::to_string(std::lround(100 * share)) +
                     " % of the lit pixels name a place that a projector of " +
                     std::to_string(panel.width) + " x " + std::to_string(panel.height) +
                     " px (width x height) does not have. Pass the size of the projector that "
                     "showed the images, and the images in their order.");
}

}  // namespace

unsigned gray_code_of(unsigned number) { return number ^ (number >> 1); }

unsigned number_of_gray_code(unsigned code) {
  unsigned number = code;
  for (unsigned shift = 1; shift < std::numeric_limits<unsigned>::digits; shift *= 2)
    number ^= number >> shift;
  return number;
}

int gray_code_length(const ImageSize& panel) {
  check_panel(panel);
  return 2 * (bits_of(panel.width) + bits_of(panel.height)) + 2;
}

std::vector<cv::Mat> draw_gray_code(const ImageSize& panel) {
  check_panel(panel);
  std::vector<cv::Mat> images;
  const auto add = [&](bool along_columns, int bit) {
    cv::Mat_<uchar> image(panel.height, panel.width);
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        const auto number = static_cast<unsigned>(along_columns ? column : row);
        image(row, column) = ((gray_code_of(number) >> bit) & 1U) != 0 ? 255 : 0;
      }
    }
    images.emplace_back(image);
    images.emplace_back(255 - image);
  };
  for (int bit = bits_of(panel.width) - 1; bit >= 0; --bit) add(true, bit);
  for (int bit = bits_of(panel.height) - 1; bit >= 0; --bit) add(false, bit);
  images.emplace_back(panel.height, panel.width, CV_8U, cv::Scalar(255));
  images.emplace_back(panel.height, panel.width, CV_8U, cv::Scalar(0));
  return images;
}

cv::Mat_<cv::Vec2f> decode_gray_code(const std::vector<cv::Mat>& images, const ImageSize& panel,
                                     const GrayCodeOptions& options) {
  require("GrayCodeOptions::min_contrast", options.min_contrast, above(0).below(1));
  check_images(images, panel);
  const int x_bits = bits_of(panel.width);
  const int y_bits = bits_of(panel.height);
  const cv::Mat_<int> x_codes = read_codes(images, 0, x_bits);
  const cv::Mat_<int> y_codes = read_codes(images, 2 * static_cast<std::size_t>(x_bits), y_bits);
  cv::Mat_<float> contrast;
  cv::subtract(images[images.size() - 2], images.back(), contrast, cv::noArray(), CV_32F);
  const auto least = static_cast<float>(options.min_contrast * full_scale(images[0]));

  cv::Mat_<cv::Vec2f> places(images[0].size(), cv::Vec2f(kUnknown, kUnknown));
  long lit = 0;
  long beyond = 0;
  for (int row = 0; row < places.rows; ++row) {
    for (int column = 0; column < places.cols; ++column) {
      if (!(contrast(row, column) >= least)) continue;
      ++lit;
      const unsigned x = number_of_gray_code(static_cast<unsigned>(x_codes(row, column)));
      const unsigned y = number_of_gray_code(static_cast<unsigned>(y_codes(row, column)));
      if (x < static_cast<unsigned>(panel.width) && y < static_cast<unsigned>(panel.height))
        places(row, column) = cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
      else
        ++beyond;
    }
  }
  check_beyond(beyond, lit, panel);
  return places;
}

}  // namespace palpate::sensing
