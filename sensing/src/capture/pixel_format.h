// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "palpate/sensing/bayer.h"

namespace palpate::sensing {

/// Layout of the pixels of an image in memory.
struct PixelFormat {
  int channels = 1;        ///< 1 or 3
  bool red_first = false;  ///< of 3 channels
  std::optional<BayerPattern> bayer = {};
  int bits = 8;  ///< 8, or 10 to 16 in the low bits of 16
};

/// The format that a name of GenICam's Pixel Format Naming Convention means; empty if Palpate does
/// not read it, such as formats whose pixels are packed more closely than in 8 or 16 bits, and YUV.
[[nodiscard]] std::optional<PixelFormat> pixel_format(const std::string& name);

/// The names that `pixel_format` knows, for messages.
[[nodiscard]] std::string known_pixel_formats();

}  // namespace palpate::sensing
