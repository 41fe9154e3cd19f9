// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::bench {

/// A frame with known truth.
struct View {
  cv::Mat frame;
  geometry::ImageF z;          ///< [mm] true depth, NaN where nothing is
  sensing::PixelMask counted;  ///< lit, visible, and facing both lenses within 65 degrees
};

/// Frames for one decoder.
struct Scene {
  std::string name;
  sensing::Rig rig;
  sensing::Pattern pattern;
  sensing::TrainedColors colors;
  std::vector<View> views;
};

/// [rad] Steeper pixels are not asked for.
inline constexpr double kMaxIncidence = 1.134;  // 65 degrees

}  // namespace palpate::bench
