// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/decode_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

#include "palpate/geometry/median.h"

namespace palpate::apps {

std::string counts(const sensing::ReasonImage& reasons) {
  std::string text;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    text += fmt::format("{}{} {}", code > 0 ? ", " : "", sensing::count(reasons, reason),
                        sensing::name(reason));
  }
  return text;
}

double median_depth(const geometry::ImageF& z) {
  std::vector<float> depths;
  depths.reserve(static_cast<std::size_t>(z.size()));
  std::copy_if(z.data(), z.data() + z.size(), std::back_inserter(depths),
               [](float depth) { return depth > 0; });
  if (depths.empty()) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(geometry::median(std::move(depths)));
}

}  // namespace palpate::apps
