// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "palpate/core/require.h"
#include "palpate/probing/press_series.h"

namespace palpate::probing {

/// A number of `SeriesOptions`, for checks and files.
struct SeriesField {
  const char* name;
  double SeriesOptions::*field;
  Interval range;
  const char* unit;
};

inline constexpr std::array<SeriesField, 9> kSeriesFields = {{
    {"touch_force", &SeriesOptions::touch_force, above(0).finite(), "N"},
    {"highest_speed", &SeriesOptions::highest_speed, above(0).finite(), "mm/s"},
    {"speed_window", &SeriesOptions::speed_window, above(0).finite(), "s"},
    {"sample_length", &SeriesOptions::sample_length, above(0).finite(), "mm"},
    {"sample_time", &SeriesOptions::sample_time, at_least(0).finite(), "s"},
    {"slide_length", &SeriesOptions::slide_length, above(0).finite(), "mm"},
    {"tare_time", &SeriesOptions::tare_time, above(0).finite(), "s"},
    {"force_delay", &SeriesOptions::force_delay, finite(), "s"},
    {"saturation", &SeriesOptions::saturation, above(0), "N"},
}};

}  // namespace palpate::probing
