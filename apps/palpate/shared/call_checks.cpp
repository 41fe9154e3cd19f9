// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/call_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "palpate/core/input_file.h"

namespace palpate::apps {

CLI::Validator within(const Interval& range) {
  return {[range](const std::string& text) {
            double number = 0;
            if (!CLI::detail::lexical_cast(text, number))
              return "is " + text + "; it must be " + to_string(range);
            return range.contains(number) ? std::string() : refusal(number, range);
          },
          to_string(range)};
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  const std::string right =
      fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
  return {[words, right](const std::string& text) {
            const bool is_right = std::ranges::find(words, text) != words.end();
            return is_right ? std::string() : "is " + text + "; it must be " + right;
          },
          fmt::format("{{{}}}", fmt::join(words, ","))};
}

std::optional<std::vector<double>> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (const char *at = text.data(), *const end = at + text.size();; ++at) {
    double number = 0;
    const auto [after, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    at = after;
    if (at == end) return numbers;
    if (*at != ',') return std::nullopt;
  }
}

std::optional<std::pair<int, int>> pair_of(const std::string& text, char between) {
  const std::size_t at = text.find(between);
  if (at == std::string::npos) return std::nullopt;
  const auto first = parse_number<int>(text.substr(0, at));
  const auto second = parse_number<int>(text.substr(at + 1));
  return first && second ? std::optional(std::pair(*first, *second)) : std::nullopt;
}

CLI::Validator list_of_numbers(std::function<bool(const std::vector<double>&)> is_right,
                               const std::string& what) {
  return {[is_right = std::move(is_right), what](const std::string& text) {
            const std::optional<std::vector<double>> numbers = numbers_of(text);
            return numbers && is_right(*numbers) ? std::string()
                                                 : "is " + text + "; it must be " + what;
          },
          ""};
}

}  // namespace palpate::apps
