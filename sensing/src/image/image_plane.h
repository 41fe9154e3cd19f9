// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "palpate/geometry/range_map.h"

namespace palpate::sensing {

/// An image of the decoder: row-major float.
using Plane = geometry::ImageF;
/// The value of a pixel that is not known.
inline constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
/// Row-major mask: 1 for true, 0 for false.
using Mask = Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns true for images that all functions for frames take: 8 or 16 bit with 1 or 3 channels.
[[nodiscard]] bool is_frame(const cv::Mat& image);
/// The largest value of a frame: 255 or 65535.
[[nodiscard]] double full_scale(const cv::Mat& frame);

/// Splits a frame into channels as fractions of full scale: green alone, or green, red, blue. The
/// memory of `out` is reused.
/// \param transposed swap rows and columns.
/// \throws InvalidInput if the frame has another type.
void split_frame(const cv::Mat& frame, bool transposed, std::vector<Plane>& out);

struct LitOptions {
  bool colored = true;      ///< the projected light lacks a channel, ambient light does not
  int radius = 0;           ///< px along the columns: half the width of the sinusoid's troughs
  double min_signal = 0.0;  ///< fraction of full scale
};

/// Finds the pixels to which the projector adds at least `min_signal`. The signal is the largest
/// minus the smallest channel, which removes colourless light, or the largest channel if not
/// `colored`. A closing along the columns over `2 radius + 1` pixels fills the sinusoid's troughs.
void find_lit(const std::vector<Plane>& channels, const LitOptions& options, Mask& lit);

/// Finds the pixels where any channel is at full scale.
void find_clipped(const std::vector<Plane>& channels, Mask& clipped);

}  // namespace palpate::sensing
