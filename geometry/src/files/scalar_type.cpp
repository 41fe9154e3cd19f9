// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/scalar_type.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

template <typename Values>
using NumberOf = typename std::decay_t<Values>::value_type;

/// The number in another notation than that of its type; nullopt if it is out of range.
template <typename Number>
std::optional<Number> convert(double number) {
  if constexpr (std::is_integral_v<Number>) {
    // 2^digits is the first number above the range, and a double.
    const bool fits = number == std::floor(number) &&
                      number >= static_cast<double>(std::numeric_limits<Number>::lowest()) &&
                      number < std::ldexp(1.0, std::numeric_limits<Number>::digits);
    if (!fits) return std::nullopt;
  } else if (std::isfinite(number) &&
             std::abs(number) > static_cast<double>(std::numeric_limits<Number>::max())) {
    return std::nullopt;
  }
  return static_cast<Number>(number);
}

}  // namespace

std::size_t size_of(Scalar type) {
  return std::visit([](const auto& numbers) { return sizeof(NumberOf<decltype(numbers)>); },
                    no_values(type));
}

Scalar type_of(const AttributeValues& values) { return static_cast<Scalar>(values.index()); }

bool is_integer(Scalar type) { return type != Scalar::float32 && type != Scalar::float64; }

AttributeValues no_values(Scalar type) {
  switch (type) {
    case Scalar::int8:
      return std::vector<std::int8_t>();
    case Scalar::uint8:
      return std::vector<std::uint8_t>();
    case Scalar::int16:
      return std::vector<std::int16_t>();
    case Scalar::uint16:
      return std::vector<std::uint16_t>();
    case Scalar::int32:
      return std::vector<std::int32_t>();
    case Scalar::uint32:
      return std::vector<std::uint32_t>();
    case Scalar::int64:
      return std::vector<std::int64_t>();
    case Scalar::uint64:
      return std::vector<std::uint64_t>();
    case Scalar::float32:
      return std::vector<float>();
    case Scalar::float64:
      break;
  }
  return std::vector<double>();
}

void append_loaded(AttributeValues& values, std::endian order, const char* bytes, std::size_t count,
                   std::size_t step) {
  std::visit(
      [&](auto& numbers) {
        for (std::size_t i = 0; i < count; ++i)
          numbers.push_back(load<NumberOf<decltype(numbers)>>(order, bytes + i * step));
      },
      values);
}

bool append_parsed(AttributeValues& values, std::string_view word) {
  return std::visit(
      [&](auto& numbers) {
        using Number = NumberOf<decltype(numbers)>;
        std::optional<Number> number = parse_number<Number>(word);
        if (!number)
          if (const std::optional<double> other = parse_number<double>(word))
            number = convert<Number>(*other);
        if (number) numbers.push_back(*number);
        return number.has_value();
      },
      values);
}

void append_bytes_of(std::string& bytes, std::endian order, const AttributeValues& values,
                     std::size_t index) {
  std::visit([&](const auto& numbers) { append_bytes(bytes, order, numbers[index]); }, values);
}

void append_digits_of(std::string& text, const AttributeValues& values, std::size_t index) {
  std::visit([&](const auto& numbers) { append_digits(text, numbers[index]); }, values);
}

}  // namespace palpate::geometry
