// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/file_names.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace palpate {
namespace {

constexpr std::string_view kDigits = "0123456789";

/// Removes the leading digits from `rest` and returns them without leading zeros.
std::string_view take_number(std::string_view& rest) {
  std::string_view number = rest.substr(0, rest.find_first_not_of(kDigits));
  rest.remove_prefix(number.size());
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

/// < 0, 0 or > 0.
int compare_numbers(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

bool begins_with_digit(std::string_view text) {
  return !text.empty() && kDigits.find(text.front()) != std::string_view::npos;
}

}  // namespace

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_hidden(const std::filesystem::path& path) {
  return path.filename().string().starts_with('.');
}

bool comes_before(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string name_a = a.filename().string();
  const std::string name_b = b.filename().string();
  std::string_view rest_a = name_a;
  std::string_view rest_b = name_b;
  while (!rest_a.empty() && !rest_b.empty()) {
    if (begins_with_digit(rest_a) && begins_with_digit(rest_b)) {
      const std::string_view number_a = take_number(rest_a);
      const int order = compare_numbers(number_a, take_number(rest_b));
      if (order != 0) return order < 0;
      continue;
    }
    if (rest_a.front() != rest_b.front()) return rest_a.front() < rest_b.front();
    rest_a.remove_prefix(1);
    rest_b.remove_prefix(1);
  }
  if (rest_a.empty() != rest_b.empty()) return rest_a.empty();
  return name_a < name_b;  // 01 and 1
}

}  // namespace palpate
