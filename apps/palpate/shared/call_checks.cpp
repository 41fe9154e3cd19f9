// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/call_checks.h"

#include <string>

#include "palpate/error.h"
#include "shared/inputs.h"

namespace palpate::apps {

namespace fs = std::filesystem;

CLI::Validator within(const Interval& range) {
  return {[range](const std::string& text) {
            double number = 0;
            const bool is_right = CLI::detail::lexical_cast(text, number) && range.contains(number);
            return is_right ? std::string() : "is " + text + "; it must be " + to_string(range);
          },
          to_string(range)};
}

void check_pictures(const std::vector<fs::path>& pictures) {
  for (const fs::path& picture : pictures) {
    if (picture.empty() || (is_image(picture) && !is_range_map(picture))) continue;
    throw InvalidInput(picture.string() +
                       ": pictures are PNG files; choose a name that ends in .png");
  }
}

void check_is_depths(const fs::path& path) {
  if (!is_sigma(path) && !is_reasons(path)) return;
  throw InvalidInput(path.string() + ": holds " +
                     (is_sigma(path) ? "the deviations of depths" : "the reasons of lost pixels") +
                     ", not depths; pass the range map beside it");
}

}  // namespace palpate::apps
