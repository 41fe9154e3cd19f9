// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/crosstalk_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

constexpr std::array<const char*, 3> kColors = {"red", "green", "blue"};
/// The number of parts into which the image is divided along each axis.
constexpr int kParts = 4;
/// Smallest number of pixels, of the image and of a part of it.
constexpr long kLeastPixels = 1000;
constexpr long kLeastPartPixels = 50;
/// Filters overlap by less; more, or less than nothing, comes from swapped or nonlinear images.
constexpr double kLeastShare = -0.1;
constexpr double kMostShare = 0.9;
/// The factor by which the noise of the unmixed channels would grow.
constexpr double kMostNoise = 10;

/// Red, green and blue of an image as fractions of full scale.
std::array<Plane, 3> channels_of(const cv::Mat& image, const char* name) {
  if (image.channels() != 3) {
    throw InvalidInput(std::string("CrosstalkImages: ") + name + ": has " +
                       std::to_string(image.channels()) +
                       (image.channels() == 1 ? " channel" : " channels") + "; three are needed");
  }
  std::vector<Plane> planes;  // green, red, blue
  split_frame(image, false, planes);
  return {std::move(planes[1]), std::move(planes[0]), std::move(planes[2])};
}

/// Sums of the light that each colour (column) adds to each channel (row).
struct Sums {
  Eigen::Matrix3d light = Eigen::Matrix3d::Zero();
  long pixels = 0;
};

Eigen::Matrix3d mixing_of(const Sums& sums) {
  Eigen::Matrix3d mixing = sums.light * sums.light.diagonal().cwiseInverse().asDiagonal();
  mixing.diagonal().setOnes();  // exactly
  return mixing;
}

void check_separable(const Eigen::Matrix3d& mixing) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double share = mixing(row, column);
      if (row == column || (share >= kLeastShare && share <= kMostShare)) continue;
      throw InvalidInput("CrosstalkImages: the camera's " +
                         std::string(kColors[static_cast<std::size_t>(row)]) + " channel sees " +
                         std::to_string(share) + " of what the " +
                         kColors[static_cast<std::size_t>(column)] +
                         " channel sees of this colour; at most 0.9 is expected. Check that the "
                         "images are not exchanged, and are linear.");
    }
  }
  if (!(mixing.inverse().cwiseAbs().maxCoeff() <= kMostNoise)) {
    throw InvalidInput(
        "CrosstalkImages: the camera's channels see almost the same mixtures of the projector's "
        "colours, so they cannot be separated");
  }
}

}  // namespace

CrosstalkCalibration calibrate_crosstalk(const CrosstalkImages& images,
                                         const CrosstalkOptions& options) {
  require("CrosstalkOptions::min_signal", options.min_signal, above(0).below(1));
  const std::array<Plane, 3> off = channels_of(images.off, "off");
  const std::array<std::array<Plane, 3>, 3> lit = {channels_of(images.red, "red"),
                                                   channels_of(images.green, "green"),
                                                   channels_of(images.blue, "blue")};
  const long rows = off[0].rows();
  const long columns = off[0].cols();
  Mask clipped = Mask::Zero(rows, columns);
  for (std::size_t color = 0; color < 3; ++color) {
    if (lit[color][0].rows() != rows || lit[color][0].cols() != columns) {
      throw InvalidInput(std::string("CrosstalkImages: ") + kColors[color] +
                         ": has another size than the image with the projector off");
    }
    Mask here;
    find_clipped({lit[color].begin(), lit[color].end()}, here);
    clipped = clipped.max(here);
  }
  std::array<Sums, kParts * kParts> parts;
  const auto least = static_cast<float>(options.min_signal);
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      if (clipped(row, column) != 0) continue;
      Eigen::Matrix3d light;
      bool enough = true;
      for (int color = 0; color < 3; ++color) {
        for (int channel = 0; channel < 3; ++channel) {
          const auto c = static_cast<std::size_t>(channel);
          const float rise =
              lit[static_cast<std::size_t>(color)][c](row, column) - off[c](row, column);
          light(channel, color) = static_cast<double>(rise);
          enough = enough && (channel != color || rise >= least);
        }
      }
      if (!enough) continue;
      Sums& part = parts[static_cast<std::size_t>(kParts * (row * kParts / rows) +
                                                  column * kParts / columns)];
      part.light += light;
      ++part.pixels;
    }
  }
  Sums all;
  for (const Sums& part : parts) {
    all.light += part.light;
    all.pixels += part.pixels;
  }
  if (all.pixels < kLeastPixels) {
    throw InvalidInput("CrosstalkImages: only " + std::to_string(all.pixels) +
                       " pixels are lit by all three colours and not overexposed; at least " +
                       std::to_string(kLeastPixels) + " are needed");
  }
  CrosstalkCalibration found{.mixing = mixing_of(all), .pixels = all.pixels};
  check_separable(found.mixing);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int used = 0;
  for (const Sums& part : parts) {
    if (part.pixels < kLeastPartPixels) continue;
    squares += (mixing_of(part) - found.mixing).cwiseAbs2();
    ++used;
  }
  found.deviation = (squares / std::max(1, used * (used - 1))).cwiseSqrt();
  return found;
}

}  // namespace palpate::sensing
