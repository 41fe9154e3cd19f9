// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/require.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "palpate/core/error.h"

namespace palpate {
namespace {

/// The shortest decimal that reads back as this number; pi by its name.
std::string limit(double value) {
  if (value == std::numbers::pi) return "pi";
  if (value == std::numbers::pi / 2) return "pi/2";
  return fmt::format("{}", value);
}

}  // namespace

std::string to_string(const Interval& range) {
  const bool from = std::abs(range.low) < kLargestNumber;
  const bool to = std::abs(range.high) < kLargestNumber;
  if (from && to) {
    return fmt::format("in {}{}, {}{}", range.low_open ? '(' : '[', limit(range.low),
                       limit(range.high), range.high_open ? ')' : ']');
  }
  const bool is_finite = std::isfinite(range.low) && std::isfinite(range.high);
  const char* and_finite = is_finite ? " and finite" : "";
  if (from)
    return fmt::format("{} {}{}", range.low_open ? ">" : ">=", limit(range.low), and_finite);
  if (to)
    return fmt::format("{} {}{}", range.high_open ? "<" : "<=", limit(range.high), and_finite);
  return is_finite ? "finite" : "a number";
}

std::string refusal(double value, const Interval& range, std::string_view unit) {
  const double end = value < 0 ? -range.low : range.high;
  const bool is_huge = std::isfinite(value) && end == kLargestNumber && std::abs(value) > end;
  return fmt::format("is {}{}{}; it must be {}", value, unit.empty() ? "" : " ", unit,
                     is_huge ? fmt::format("at most {} in magnitude", end) : to_string(range));
}

void require(std::string_view name, double value, const Interval& range, std::string_view unit) {
  if (range.contains(value)) return;
  throw InvalidInput(
      std::vector<MessagePart>{{std::string(name), true}, {" " + refusal(value, range, unit)}});
}

void require(std::string_view name, const std::optional<double>& value, const Interval& range,
             std::string_view unit) {
  if (value) require(name, *value, range, unit);
}

void require_given(std::string_view name, bool is_given) {
  if (is_given) return;
  throw InvalidInput(std::vector<MessagePart>{{std::string(name), true}, {" must be given"}});
}

void require_one_of(std::string_view name, int value, std::initializer_list<int> choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  std::string words;
  for (const int& choice : choices) {
    if (&choice != choices.begin()) words += &choice + 1 == choices.end() ? " or " : ", ";
    words += fmt::format("{}", choice);
  }
  throw InvalidInput(std::vector<MessagePart>{
      {std::string(name), true}, {fmt::format(" is {}; it must be {}", value, words)}});
}

}  // namespace palpate
