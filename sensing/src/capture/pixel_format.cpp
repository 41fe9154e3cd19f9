// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/pixel_format.h"

#include <array>
#include <string_view>
#include <utility>

namespace palpate::sensing {
namespace {

constexpr std::array<std::pair<std::string_view, BayerPattern>, 4> kMosaics{
    {{"BayerRG", BayerPattern::rggb},
     {"BayerBG", BayerPattern::bggr},
     {"BayerGR", BayerPattern::grbg},
     {"BayerGB", BayerPattern::gbrg}}};

/// The number of bits after `start`; 0 if there is something else.
int bits_after(std::string_view name, std::string_view start) {
  if (!name.starts_with(start)) return 0;
  name.remove_prefix(start.size());
  for (const int bits : {8, 10, 12, 14, 16}) {
    if (name == std::to_string(bits)) return bits;
  }
  return 0;
}

}  // namespace

std::optional<PixelFormat> pixel_format(const std::string& name) {
  if (const int bits = bits_after(name, "Mono")) return PixelFormat{.bits = bits};
  for (const auto& [start, pattern] : kMosaics) {
    if (const int bits = bits_after(name, start))
      return PixelFormat{.bayer = pattern, .bits = bits};
  }
  for (const char* color : {"RGB8", "BGR8"}) {
    if (name == color || name == std::string(color) + "Packed")
      return PixelFormat{.channels = 3, .red_first = name[0] == 'R'};
  }
  return std::nullopt;
}

std::string known_pixel_formats() {
  return "Mono8 to Mono16, BayerRG8 to BayerRG16 (and BG, GR, GB), RGB8 or BGR8";
}

}  // namespace palpate::sensing
