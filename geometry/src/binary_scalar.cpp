// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "binary_scalar.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace palpate::geometry {
namespace {

template <typename Number>
double load_as(std::endian order, const char* bytes) {
  std::array<char, sizeof(Number)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(Number));
  if (order != std::endian::native) std::reverse(ordered.begin(), ordered.end());
  return static_cast<double>(std::bit_cast<Number>(ordered));
}

template <typename Number>
void append(std::string& bytes, Number value) {
  auto ordered = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if (std::endian::native != std::endian::little) std::reverse(ordered.begin(), ordered.end());
  bytes.append(ordered.data(), ordered.size());
}

}  // namespace

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::int8:
    case Scalar::uint8:
      return 1;
    case Scalar::int16:
    case Scalar::uint16:
      return 2;
    case Scalar::int32:
    case Scalar::uint32:
    case Scalar::float32:
      return 4;
    case Scalar::int64:
    case Scalar::uint64:
    case Scalar::float64:
      break;
  }
  return 8;
}

double load(Scalar type, std::endian order, const char* bytes) {
  switch (type) {
    case Scalar::int8:
      return load_as<std::int8_t>(order, bytes);
    case Scalar::uint8:
      return load_as<std::uint8_t>(order, bytes);
    case Scalar::int16:
      return load_as<std::int16_t>(order, bytes);
    case Scalar::uint16:
      return load_as<std::uint16_t>(order, bytes);
    case Scalar::int32:
      return load_as<std::int32_t>(order, bytes);
    case Scalar::uint32:
      return load_as<std::uint32_t>(order, bytes);
    case Scalar::int64:
      return load_as<std::int64_t>(order, bytes);
    case Scalar::uint64:
      return load_as<std::uint64_t>(order, bytes);
    case Scalar::float32:
      return load_as<float>(order, bytes);
    case Scalar::float64:
      break;
  }
  return load_as<double>(order, bytes);
}

void append_little_endian(std::string& bytes, double value) { append(bytes, value); }

void append_little_endian(std::string& bytes, int value) { append(bytes, value); }

}  // namespace palpate::geometry
