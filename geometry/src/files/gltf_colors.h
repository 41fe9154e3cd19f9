// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace palpate::geometry {

// glTF stores colours of vertices as linear RGB. Our attributes, as those of PLY and OBJ, are sRGB.

/// The intensity for red, green or blue of sRGB.
inline double linear_intensity(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// The inverse.
inline double srgb_value(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace palpate::geometry
