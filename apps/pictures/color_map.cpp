// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "color_map.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace palpate::pictures {
namespace {

/// Even samples of viridis (van der Walt and Smith 2015; CC0).
constexpr std::array<Rgb, 10> kViridis{{{68, 1, 84},
                                        {72, 40, 120},
                                        {62, 73, 137},
                                        {49, 104, 142},
                                        {38, 130, 142},
                                        {31, 158, 137},
                                        {53, 183, 121},
                                        {110, 206, 88},
                                        {181, 222, 43},
                                        {253, 231, 37}}};

/// Blue to red over white (the colours of Brewer's RdBu).
constexpr std::array<Rgb, 9> kBlueWhiteRed{{{33, 102, 172},
                                            {67, 147, 195},
                                            {146, 197, 222},
                                            {209, 229, 240},
                                            {255, 255, 255},
                                            {253, 219, 199},
                                            {244, 165, 130},
                                            {214, 96, 77},
                                            {178, 24, 43}}};

}  // namespace

Rgb color_at(ColorMap map, double fraction) {
  if (std::isnan(fraction)) {
    return kUnknownColor;
  }
  const std::span<const Rgb> table = map == ColorMap::sequential
                                         ? std::span<const Rgb>(kViridis)
                                         : std::span<const Rgb>(kBlueWhiteRed);
  const double place = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(table.size() - 1);
  const auto left = std::min(static_cast<std::size_t>(place), table.size() - 2);
  const double part = place - static_cast<double>(left);
  Rgb color{};
  for (std::size_t channel = 0; channel < color.size(); ++channel) {
    const double from = table[left][channel];
    const double to = table[left + 1][channel];
    color[channel] = static_cast<std::uint8_t>(std::lround(from + part * (to - from)));
  }
  return color;
}

}  // namespace palpate::pictures
