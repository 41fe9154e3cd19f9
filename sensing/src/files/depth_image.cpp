// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_image.h"

#include <array>
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
