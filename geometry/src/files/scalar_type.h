// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

#include "palpate/geometry/attribute.h"

namespace palpate::geometry {

/// Number types in mesh files, in the order of the alternatives of AttributeValues.
enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(Scalar type);
[[nodiscard]] Scalar type_of(const AttributeValues& values);
[[nodiscard]] bool is_integer(Scalar type);

/// Empty values of a type.
[[nodiscard]] AttributeValues no_values(Scalar type);

/// Reads one number from its bytes.
template <typename Number>
[[nodiscard]] Number load(std::endian order, const char* bytes) {
  std::array<char, sizeof(Number)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(Number));
  if (order != std::endian::native) std::reverse(ordered.begin(), ordered.end());
  return std::bit_cast<Number>(ordered);
}

/// Appends the bytes of one number.
template <typename Number>
void append_bytes(std::string& bytes, std::endian order, Number value) {
  auto ordered = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if (order != std::endian::native) std::reverse(ordered.begin(), ordered.end());
  bytes.append(ordered.data(), ordered.size());
}

/// Appends a number with enough digits to read it back exactly.
template <typename Number>
void append_digits(std::string& text, Number value) {
  std::array<char, 32> digits;  // the longest double takes 24
  const auto [end, error] = std::to_chars(digits.begin(), digits.end(), value);
  text.append(digits.begin(), end);
}

/// Appends `count` numbers that are `step` bytes apart.
void append_loaded(AttributeValues& values, std::endian order, const char* bytes, std::size_t count,
                   std::size_t step);

/// Parses `word` and appends the number; false if the type cannot hold it or it is not a number. An
/// integer may be written as 3.0 or 3e2; a floating point number is rounded to its type.
[[nodiscard]] bool append_parsed(AttributeValues& values, std::string_view word);

/// Appends the number at `index` as bytes or as digits.
void append_bytes_of(std::string& bytes, std::endian order, const AttributeValues& values,
                     std::size_t index);
void append_digits_of(std::string& text, const AttributeValues& values, std::size_t index);

}  // namespace palpate::geometry
