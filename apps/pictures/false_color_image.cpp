// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "false_color_image.h"

#include <algorithm>
#include <cmath>

#include "canvas.h"

namespace palpate::pictures {
namespace {

constexpr double kScaleSpace = 160;        ///< px right of the image, for the scale and its numbers
constexpr double kUnknownSpace = 50;       ///< px below the scale, for what grey means
constexpr double kLeastScaleHeight = 320;  ///< px

Rgb color_of(double value, const FalseColor& options) {
  return color_at(options.map, std::isfinite(value)
                                   ? (value - options.low) / (options.high - options.low)
                                   : std::nan(""));
}

/// The image at `magnification` picture px a pixel, each of its pixels one colour.
Pixels magnify(const geometry::ImageF& image, double magnification, const FalseColor& options) {
  Pixels pixels;
  pixels.width = std::max(1, static_cast<int>(static_cast<double>(image.cols()) * magnification));
  pixels.height = std::max(1, static_cast<int>(static_cast<double>(image.rows()) * magnification));
  for (int y = pixels.height - 1; y >= 0; --y) {
    const Eigen::Index row = y * image.rows() / pixels.height;
    for (int x = 0; x < pixels.width; ++x) {
      const Eigen::Index col = x * image.cols() / pixels.width;
      pixels.colors.push_back(color_of(static_cast<double>(image(row, col)), options));
    }
  }
  return pixels;
}

}  // namespace

void draw_false_color(const std::filesystem::path& png, const geometry::ImageF& image,
                      const FalseColor& options, const std::string& title,
                      const std::string& subtitle) {
  Canvas canvas(Canvas::kHeight, title, subtitle);
  const double room_x = Canvas::kWidth - kScaleSpace - 2 * kImageMargin;
  const double room_y = canvas.top() - kImageMargin;
  const double magnification = std::min(room_x / static_cast<double>(image.cols()),
                                        room_y / static_cast<double>(image.rows()));
  const Pixels pixels = magnify(image, magnification, options);
  const Box box{std::round(kImageMargin + (room_x - pixels.width) / 2),
                std::round(kImageMargin + (room_y - pixels.height) / 2),
                static_cast<double>(pixels.width), static_cast<double>(pixels.height)};
  canvas.add_pixels({box.x, box.y}, pixels);
  canvas.add_outline(box);

  // As high as the image, but not too low for its numbers.
  const double height = std::max(box.height, kLeastScaleHeight);
  Box scale{box.x + box.width + kImageMargin, std::round(kImageMargin + (room_y - height) / 2),
            kScaleWidth, height};
  if (!image.isFinite().all()) {
    const Box patch{scale.x, scale.y, kScaleWidth, kScaleWidth};
    canvas.add_rectangle(patch, kUnknownColor);
    canvas.add_outline(patch);
    canvas.add_text({patch.x + patch.width + kScaleNumberGap, patch.y + patch.height / 2},
                    "unknown", {.across = Align::low});
    scale.y += kUnknownSpace;
    scale.height -= kUnknownSpace;
  }
  add_color_scale(canvas, scale, options);
  canvas.write(png);
}

}  // namespace palpate::pictures
