// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_range_map.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "background.h"
#include "depth_span.h"
#include "false_color_image.h"
#include "input_checks.h"
#include "ticks.h"

namespace palpate::pictures {
void draw_range_map(const std::filesystem::path& png, const geometry::RangeMap& map,
                    const std::string& title) {
  check_image(map.z, "range map");
  std::vector<double> known;
  for (const float z : map.z.reshaped<Eigen::RowMajor>()) {
    if (std::isfinite(z)) known.push_back(static_cast<double>(z));
  }
  const auto [nearest, farthest] = std::minmax_element(known.begin(), known.end());
  const double share =
      100.0 * static_cast<double>(known.size()) / static_cast<double>(map.z.size());
  const std::string subtitle = std::to_string(map.z.cols()) + " x " + std::to_string(map.z.rows()) +
                               " pixels, " + format_value(share, 0.1) + " % known, " +
                               format_value(*nearest, 0.1) + " to " + format_value(*farthest, 0.1) +
                               " mm";
  FalseColorPicture picture;
  picture.title = title;
  picture.subtitle = subtitle;
  if (const std::optional<double> background = background_border(known)) {
    picture.object = map.z.cast<double>() < *background;
    std::erase_if(known, [&](double z) { return z >= *background; });
  }
  const DepthSpan span = depth_span(std::move(known));
  picture.colors = {span.low, span.high, ColorMap::sequential, "depth (mm)"};
  draw_false_color(png, map.z, picture);
}

}  // namespace palpate::pictures
