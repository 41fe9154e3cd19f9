// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "false_color_image.h"

#include <algorithm>
#include <cmath>

#include "canvas.h"

namespace palpate::pictures {
namespace {

constexpr double kScaleSpace = 160;        ///< px right of the image, for the scale and its numbers
constexpr double kKeySpace = 50;           ///< px below the scale, for what a plain colour means
constexpr double kLeastScaleHeight = 320;  ///< px

/// Around the object, of its longer side.
constexpr double kAround = 0.04;
/// An object that takes this much of the image's width and height is shown with the whole image.
constexpr double kWhole = 0.8;

/// Part of an image, in its pixels.
struct View {
  Eigen::Index row = 0, col = 0, rows = 0, cols = 0;
};

/// The part that contains the pixels of `object`, with some room around it.
View view_of(const geometry::PixelMask& object) {
  const View whole{0, 0, object.rows(), object.cols()};
  View box{object.rows(), object.cols(), 0, 0};
  for (Eigen::Index row = 0; row < object.rows(); ++row) {
    for (Eigen::Index col = 0; col < object.cols(); ++col) {
      if (!object(row, col)) continue;
      box.row = std::min(box.row, row);
      box.col = std::min(box.col, col);
      box.rows = std::max(box.rows, row + 1);
      box.cols = std::max(box.cols, col + 1);
    }
  }
  box.rows -= box.row;
  box.cols -= box.col;
  if (static_cast<double>(box.rows) >= kWhole * static_cast<double>(whole.rows) &&
      static_cast<double>(box.cols) >= kWhole * static_cast<double>(whole.cols)) {
    return whole;
  }
  const auto around = static_cast<Eigen::Index>(
      std::ceil(kAround * static_cast<double>(std::max(box.rows, box.cols))));
  const Eigen::Index row = std::max<Eigen::Index>(box.row - around, 0);
  const Eigen::Index col = std::max<Eigen::Index>(box.col - around, 0);
  return {row, col, std::min(box.row + box.rows + around, whole.rows) - row,
          std::min(box.col + box.cols + around, whole.cols) - col};
}

/// The part of an image at `magnification` picture px a pixel, each of its pixels one colour.
Pixels magnify(const geometry::ImageF& image, const View& view, double magnification,
               const FalseColorPicture& picture) {
  Pixels pixels;
  pixels.width = std::max(1, static_cast<int>(static_cast<double>(view.cols) * magnification));
  pixels.height = std::max(1, static_cast<int>(static_cast<double>(view.rows) * magnification));
  const FalseColor& colors = picture.colors;
  for (int y = pixels.height - 1; y >= 0; --y) {
    const Eigen::Index row = view.row + y * view.rows / pixels.height;
    for (int x = 0; x < pixels.width; ++x) {
      const Eigen::Index col = view.col + x * view.cols / pixels.width;
      const auto value = static_cast<double>(image(row, col));
      const bool marked = picture.marked.size() > 0 && picture.marked(row, col);
      pixels.colors.push_back(
          marked ? kBlack
                 : color_at(colors.map, std::isfinite(value)
                                            ? (value - colors.low) / (colors.high - colors.low)
                                            : std::nan("")));
    }
  }
  return pixels;
}

}  // namespace

void draw_false_color(const std::filesystem::path& png, const geometry::ImageF& image,
                      const FalseColorPicture& picture) {
  const bool has_marks = picture.marked.size() > 0 && picture.marked.any();
  geometry::PixelMask object = picture.object;
  if (object.size() == 0) object = image.isFinite();
  if (picture.object.size() == 0 && has_marks) object = object || picture.marked;
  const View view = view_of(object);
  std::string subtitle = picture.subtitle;
  if (view.rows < image.rows() || view.cols < image.cols()) {
    subtitle += "; shown: columns " + std::to_string(view.col) + " to " +
                std::to_string(view.col + view.cols - 1) + ", rows " + std::to_string(view.row) +
                " to " + std::to_string(view.row + view.rows - 1);
  }
  Canvas canvas(Canvas::kHeight, picture.title, subtitle);
  const double room_x = Canvas::kWidth - kScaleSpace - 2 * kImageMargin;
  const double room_y = canvas.top() - kImageMargin;
  const double magnification =
      std::min(room_x / static_cast<double>(view.cols), room_y / static_cast<double>(view.rows));
  const Pixels pixels = magnify(image, view, magnification, picture);
  const Box box{std::round(kImageMargin + (room_x - pixels.width) / 2),
                std::round(kImageMargin + (room_y - pixels.height) / 2),
                static_cast<double>(pixels.width), static_cast<double>(pixels.height)};
  canvas.add_pixels({box.x, box.y}, pixels);
  canvas.add_outline(box);

  // As high as the image, but not too low for its numbers.
  const double height = std::max(box.height, kLeastScaleHeight);
  Box scale{box.x + box.width + kImageMargin, std::round(kImageMargin + (room_y - height) / 2),
            kScaleWidth, height};
  const auto add_key = [&](const Rgb& color, const std::string& meaning) {
    const Box patch{scale.x, scale.y, kScaleWidth, kScaleWidth};
    canvas.add_rectangle(patch, color);
    canvas.add_outline(patch);
    canvas.add_text({patch.x + patch.width + kScaleNumberGap, patch.y + patch.height / 2}, meaning,
                    {.across = Align::low});
    scale.y += kKeySpace;
    scale.height -= kKeySpace;
  };
  const auto shown = image.block(view.row, view.col, view.rows, view.cols);
  if (!shown.isFinite().all()) add_key(kUnknownColor, "unknown");
  if (has_marks) add_key(kBlack, picture.mark);
  FalseColor colors = picture.colors;
  for (const float value : shown.reshaped()) {
    colors.any_below |= std::isfinite(value) && static_cast<double>(value) < colors.low;
    colors.any_above |= std::isfinite(value) && static_cast<double>(value) > colors.high;
  }
  add_color_scale(canvas, scale, colors);
  canvas.write(png);
}

}  // namespace palpate::pictures
