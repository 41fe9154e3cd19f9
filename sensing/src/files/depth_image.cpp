// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/frame.h"

namespace palpate::sensing {
namespace {

constexpr double kMostUnits = std::numeric_limits<std::uint16_t>::max();

/// The smallest of 1, 2 and 5 times powers of ten that is at least `length`.
double next_round(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= length) return factor * power;
  return 10 * power;
}

std::uint16_t in_units(const std::filesystem::path& path, double depth, double mm_per_unit) {
  const double units = std::round(depth / mm_per_unit);
  if (units > kMostUnits) {
    throw InvalidInput(fmt::format(
        "{}: a depth of {:.6g} mm is beyond 16 bits with units of {:g} mm, which reach {:g} mm; "
        "units of {:g} mm are long enough for it",
        path.string(), depth, mm_per_unit, kMostUnits * mm_per_unit,
        next_round(depth / kMostUnits)));
  }
  if (units < 1) {
    throw InvalidInput(fmt::format(
        "{}: a depth of {:.6g} mm would become 0, which means unknown; units of at most {:.6g} mm "
        "are short enough for it, not {:g} mm",
        path.string(), depth, depth, mm_per_unit));
  }
  return static_cast<std::uint16_t>(units);
}

}  // namespace

geometry::RangeMap read_depth_image(const std::filesystem::path& path, double mm_per_unit,
                                    const geometry::Camera& camera) {
  geometry::check_camera(camera, "read_depth_image: camera");
  require("read_depth_image(): mm_per_unit", mm_per_unit, above(0).finite(), "mm");
  const cv::Mat image = read_frame(path);
  if (image.type() != CV_16UC1) {
    throw FileError(path.string() + ": a depth image has 16 bit and one channel");
  }
  if (image.cols != camera.width || image.rows != camera.height) {
    throw FileError(path.string() + ": is " + std::to_string(image.cols) + " x " +
                    std::to_string(image.rows) + ", the camera " + std::to_string(camera.width) +
                    " x " + std::to_string(camera.height) +
                    " px; pass the camera of these images, which is the colour camera if depths "
                    "are aligned with its images");
  }
  geometry::RangeMap map{geometry::ImageF(image.rows, image.cols), camera};
  for (int row = 0; row < image.rows; ++row) {
    const auto* units = image.ptr<std::uint16_t>(row);
    for (int column = 0; column < image.cols; ++column) {
      map.z(row, column) = units[column] == 0 ? std::numeric_limits<float>::quiet_NaN()
                                              : static_cast<float>(units[column] * mm_per_unit);
    }
  }
  return map;
}

void write_depth_image(const std::filesystem::path& path, const geometry::ImageF& z,
                       double mm_per_unit) {
  require("write_depth_image(): mm_per_unit", mm_per_unit, above(0).finite(), "mm");
  if (z.size() == 0) throw InvalidInput(path.string() + ": depths without pixels to write");
  cv::Mat1w image(static_cast<int>(z.rows()), static_cast<int>(z.cols()));
  std::ranges::transform(z.reshaped<Eigen::RowMajor>(), image.begin(), [&](float depth) {
    const bool is_known = depth > 0 && std::isfinite(depth);
    return is_known ? in_units(path, static_cast<double>(depth), mm_per_unit) : std::uint16_t{0};
  });
  write_png(path, image);
}

std::optional<PngPixels> read_png_pixels(const std::filesystem::path& path) {
  // The signature, and a first chunk with size (8 bytes), bit depth and colour type.
  constexpr std::string_view kStart("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  constexpr std::size_t kBitDepth = 24, kColourType = 25;
  constexpr int kColour = 2;  // flag of the colour type, also set for a palette
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError(path.string() + ": cannot be opened.");
  std::array<char, kColourType + 1> bytes{};
  in.read(bytes.data(), bytes.size());
  if (!in || std::string_view(bytes.data(), kStart.size()) != kStart) return std::nullopt;
  return PngPixels{.bits = bytes[kBitDepth],
                   .channels = (bytes[kColourType] & kColour) != 0 ? 3 : 1};
}

}  // namespace palpate::sensing
