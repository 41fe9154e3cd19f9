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

/// The channels of a frame as fractions of full scale: green alone, or green, red, blue. Memory of
/// `out` is used again.
/// \param transposed whether rows and columns change places.
/// \throws InvalidInput on another type.
void split_frame(const cv::Mat& frame, bool transposed, std::vector<Plane>& out);

struct LitOptions {
  bool colored = true;      ///< the projector's light lacks a channel, other light does not
  int radius = 0;           ///< px along the columns: half a trough of the sinusoid
  double min_signal = 0.0;  ///< fraction of full scale
};

/// Where the projector adds at least `min_signal`: the largest minus the smallest channel (light of
/// no colour falls out), or the largest if not `colored`; dark troughs of the sinusoid filled by a
/// closing along the columns over `2 radius + 1` pixels.
void find_lit(const std::vector<Plane>& channels, const LitOptions& options, Mask& lit);

}  // namespace palpate::sensing
