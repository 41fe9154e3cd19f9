// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace palpate::pictures {

using Rgb = std::array<std::uint8_t, 3>;

/// Colour of unknown values.
inline constexpr Rgb kUnknownColor{211, 211, 211};

/// Colours of lines, markers and arrows from Okabe and Ito (2008), which people with any kind of
/// colour blindness can distinguish.
inline constexpr Rgb kBlack{0, 0, 0};
inline constexpr Rgb kBlue{0, 114, 178};
inline constexpr Rgb kVermilion{213, 94, 0};
inline constexpr Rgb kGreen{0, 158, 115};
inline constexpr Rgb kPurple{204, 121, 167};
inline constexpr Rgb kOrange{230, 159, 0};
inline constexpr Rgb kSky{86, 180, 233};
inline constexpr Rgb kGrey{110, 110, 110};

/// Colours of labels, such as the reasons of pixels; the first one is that of what has none.
inline constexpr std::array<Rgb, 12> kLabelColors{
    kUnknownColor,     kBlack,           kVermilion,      kBlue,
    kOrange,           kGreen,           kPurple,         kSky,
    Rgb{240, 228, 66}, Rgb{120, 60, 20}, Rgb{150, 0, 60}, Rgb{70, 70, 160}};

enum class ColorMap {
  sequential,  ///< viridis: dark blue, green, yellow; uniform steps of lightness
  diverging    ///< blue, white, red; white is the middle
};

/// The colour at `fraction` of the map, clamped to 0 (low end) and 1 (high end). NaN gives
/// kUnknownColor.
[[nodiscard]] Rgb color_at(ColorMap map, double fraction);

}  // namespace palpate::pictures
