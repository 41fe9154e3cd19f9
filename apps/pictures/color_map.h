// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace palpate::pictures {

using Rgb = std::array<std::uint8_t, 3>;

/// For values that are not known.
inline constexpr Rgb kUnknownColor{211, 211, 211};

/// The colours of lines, markers and arrows: those of Okabe and Ito (2008), which people with any
/// kind of colour blindness tell apart.
inline constexpr Rgb kBlack{0, 0, 0};
inline constexpr Rgb kBlue{0, 114, 178};
inline constexpr Rgb kVermilion{213, 94, 0};
inline constexpr Rgb kGreen{0, 158, 115};
inline constexpr Rgb kPurple{204, 121, 167};
inline constexpr Rgb kOrange{230, 159, 0};
inline constexpr Rgb kSky{86, 180, 233};
inline constexpr Rgb kGrey{110, 110, 110};

enum class ColorMap {
  sequential,  ///< viridis: dark blue, green, yellow; even steps of lightness
  diverging    ///< blue, white, red; white is the middle
};

/// The colour at `fraction` of the map, 0 at its low end and 1 at its high end; beyond, the end's.
/// NaN gives kUnknownColor.
[[nodiscard]] Rgb color_at(ColorMap map, double fraction);

}  // namespace palpate::pictures
