// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "color_scale.h"

#include <algorithm>

#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kScaleLabelGap = 28;  ///< px from the numbers to the middle of the label
constexpr int kMostTicks = 9;

}  // namespace

void add_color_scale(Canvas& canvas, const Box& box, const FalseColor& options) {
  Pixels bar{static_cast<int>(box.width), static_cast<int>(box.height), {}};
  for (int y = 0; y < bar.height; ++y) {
    bar.colors.insert(bar.colors.end(), static_cast<std::size_t>(bar.width),
                      color_at(options.map, (y + 0.5) / bar.height));
  }
  canvas.add_pixels({box.x, box.y}, bar);
  canvas.add_outline(box);
  const double right = box.x + box.width;
  const Ticks ticks = make_ticks(options.low, options.high, kMostTicks);
  double widest = 0;
  for (std::size_t index = 0; index < ticks.values.size(); ++index) {
    const double y =
        box.y + box.height * (ticks.values[index] - options.low) / (options.high - options.low);
    canvas.add_line(Eigen::Matrix2d{{right, right + kTickLength}, {y, y}}, kGrey);
    const TextStyle style{.across = Align::low};
    canvas.add_text({right + kScaleNumberGap, y}, ticks.labels[index], style);
    widest = std::max(widest, canvas.text_size(ticks.labels[index], style).x());
  }
  canvas.add_text({right + widest + kScaleLabelGap, box.y + box.height / 2}, options.scale,
                  {.size = 17, .upwards = true});
}

}  // namespace palpate::pictures
