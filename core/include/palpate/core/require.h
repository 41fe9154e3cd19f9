// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// The largest number that `Interval::finite` lets pass: products of three numbers stay finite.
inline constexpr double kLargestNumber = 1e100;

/// A range of numbers. Each end is open or closed; an infinite end that is closed contains
/// infinity. NaN is in no range.
///
///     above(0)               > 0
///     at_least(0).finite()   >= 0 and finite
///     above(0).at_most(1)    in (0, 1]
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  [[nodiscard]] constexpr bool contains(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// The same lower end with another upper end.
  [[nodiscard]] constexpr Interval at_most(double end) const { return {low, end, low_open, false}; }
  [[nodiscard]] constexpr Interval below(double end) const { return {low, end, low_open, true}; }
  /// The same range without infinities and without numbers beyond `kLargestNumber`.
  [[nodiscard]] constexpr Interval finite() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {low == -kInfinity ? -kLargestNumber : low, high == kInfinity ? kLargestNumber : high,
            low_open, high_open};
  }
};

[[nodiscard]] constexpr Interval at_least(double low) { return {.low = low}; }
[[nodiscard]] constexpr Interval above(double low) { return {.low = low, .low_open = true}; }
[[nodiscard]] constexpr Interval finite() { return Interval{}.finite(); }

/// The words that a message has after "it must be": "> 0", ">= 0 and finite", "in (0, 1]",
/// "finite". Pi and pi/2 have their names.
[[nodiscard]] std::string to_string(const Interval& range);

/// The words of a message about a value outside its range: "is -1 mm; it must be > 0".
[[nodiscard]] std::string refusal(double value, const Interval& range, std::string_view unit = {});

/// Checks an argument or an option. The message always has the same form:
/// "DecodeOptions::min_signal is -1; it must be in (0, 1)".
/// \param name of the argument, or of the field with its struct or its place in a file
/// \param unit of value and range, such as "mm"; empty for a plain number
/// \throws InvalidInput unless `range` contains `value`.
void require(std::string_view name, double value, const Interval& range,
             std::string_view unit = {});

/// The same for an option that may be left out.
void require(std::string_view name, const std::optional<double>& value, const Interval& range,
             std::string_view unit = {});

/// Checks an option without a default.
/// \throws InvalidInput unless it is given: "RemeshingOptions::edge_length must be given".
void require_given(std::string_view name, bool is_given);

/// The same for checks of many values: `name` is a function, called only for the message.
template <std::invocable Name>
void require(const Name& name, double value, const Interval& range, std::string_view unit = {}) {
  if (!range.contains(value)) require(std::string_view(name()), value, range, unit);
}

/// \throws InvalidInput unless `value` is one of `choices`: "bits is 12; it must be 8 or 16".
void require_one_of(std::string_view name, int value, std::initializer_list<int> choices);

}  // namespace palpate
