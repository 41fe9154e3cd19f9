// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "palpate/geometry/range_map.h"

namespace palpate::sensing {

/// One image of the decoder: row-major float.
using Plane = geometry::ImageF;
/// 1 where something holds.
using Mask = Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The channels of a frame as fractions of full scale: green alone, or green, red, blue.
/// \param transposed whether rows and columns change places.
/// \throws InvalidInput on another type.
[[nodiscard]] std::vector<Plane> split_frame(const cv::Mat& frame, bool transposed);

/// What the projector adds, bright troughs of the sinusoid filled: the largest minus the smallest
/// channel (light of no colour falls out), or the only channel; then a grey closing along the
/// columns over `2 radius + 1` pixels.
[[nodiscard]] Plane projector_light(const std::vector<Plane>& channels, bool colored, int radius);

}  // namespace palpate::sensing
