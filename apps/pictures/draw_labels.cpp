// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_labels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "canvas.h"
#include "color_map.h"
#include "palpate/core/error.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kLegendSpace = 300;  ///< px right of the image
constexpr double kPatch = 26;         ///< px, side of a colour in the legend
constexpr double kLineHeight = 44;    ///< px from one line of the legend to the next
constexpr double kGap = 11;           ///< px from a patch to its meaning

void check(const LabelImage& labels, std::span<const std::string> names) {
  if (labels.size() == 0) throw InvalidInput("labels: the image is empty");
  if (names.empty() || names.size() > kLabelColors.size()) {
    throw InvalidInput("labels: there are " + std::to_string(names.size()) +
                       " names; from 1 to 12 can be told apart");
  }
  const int largest = labels.maxCoeff();
  if (largest >= static_cast<int>(names.size())) {
    throw InvalidInput("labels: there is a label " + std::to_string(largest) + ", but only " +
                       std::to_string(names.size()) + " names");
  }
}

/// The lowest row first, as a canvas wants it.
Pixels magnify(const LabelImage& labels, double magnification) {
  Pixels pixels;
  pixels.width = std::max(1, static_cast<int>(static_cast<double>(labels.cols()) * magnification));
  pixels.height = std::max(1, static_cast<int>(static_cast<double>(labels.rows()) * magnification));
  for (int y = pixels.height - 1; y >= 0; --y) {
    const Eigen::Index row = y * labels.rows() / pixels.height;
    for (int x = 0; x < pixels.width; ++x) {
      pixels.colors.push_back(kLabelColors[labels(row, x * labels.cols() / pixels.width)]);
    }
  }
  return pixels;
}

}  // namespace

void draw_labels(const std::filesystem::path& png, const LabelImage& labels,
                 std::span<const std::string> names, const std::string& title) {
  check(labels, names);
  Canvas canvas(Canvas::kHeight, title,
                std::to_string(labels.cols()) + " x " + std::to_string(labels.rows()) + " pixels");
  const double room_x = Canvas::kWidth - kLegendSpace - 2 * kImageMargin;
  const double room_y = canvas.top() - kImageMargin;
  const Pixels pixels = magnify(labels, std::min(room_x / static_cast<double>(labels.cols()),
                                                 room_y / static_cast<double>(labels.rows())));
  const Box box{std::round(kImageMargin + (room_x - pixels.width) / 2),
                std::round(kImageMargin + (room_y - pixels.height) / 2),
                static_cast<double>(pixels.width), static_cast<double>(pixels.height)};
  canvas.add_pixels({box.x, box.y}, pixels);
  canvas.add_outline(box);

  const double height = kLineHeight * static_cast<double>(names.size());
  double y = std::round(kImageMargin + (room_y + height) / 2) - kPatch;
  for (std::size_t label = 0; label < names.size(); ++label, y -= kLineHeight) {
    const Box patch{box.x + box.width + kImageMargin, y, kPatch, kPatch};
    const auto pixels_of = (labels == static_cast<std::uint8_t>(label)).count();
    const double percent =
        100.0 * static_cast<double>(pixels_of) / static_cast<double>(labels.size());
    canvas.add_rectangle(patch, kLabelColors[label]);
    canvas.add_outline(patch);
    canvas.add_text({patch.x + patch.width + kGap, patch.y + patch.height / 2},
                    names[label] + ", " + format_value(percent, 0.01) + " %",
                    {.across = Align::low});
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
