// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/morton_curve.h"

#include <array>
#include <cstddef>

namespace palpate::geometry {
namespace {

/// Puts two zeros between the bits of a number below 2^16.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 16U) & 0x0000ff0000ffU;
  x = (x | x << 8U) & 0x00f00f00f00fU;
  x = (x | x << 4U) & 0x0c30c30c30c3U;
  return (x | x << 2U) & 0x249249249249U;
}

}  // namespace

std::uint64_t morton_place(const Eigen::Array<std::uint32_t, 3, 1>& cell) {
  return spread_bits(cell[0]) | spread_bits(cell[1]) << 1U | spread_bits(cell[2]) << 2U;
}

// Radix sort: by the digits, from the last to the first.
std::vector<OnMortonCurve> sorted(std::vector<OnMortonCurve> all) {
  constexpr unsigned kBits = 48, kDigit = 12;
  constexpr std::size_t kDigits = std::size_t{1} << kDigit;
  std::vector<OnMortonCurve> next(all.size());
  for (unsigned shift = 0; shift < kBits; shift += kDigit) {
    const auto digit = [&](const OnMortonCurve& one) { return (one.place >> shift) % kDigits; };
    std::array<std::size_t, kDigits + 1> begin = {};
    for (const OnMortonCurve& one : all) ++begin[digit(one) + 1];
    for (std::size_t i = 1; i < kDigits; ++i) begin[i] += begin[i - 1];
    for (const OnMortonCurve& one : all) next[begin[digit(one)]++] = one;
    all.swap(next);
  }
  return all;
}

}  // namespace palpate::geometry
