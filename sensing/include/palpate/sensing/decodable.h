// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "palpate/sensing/bayer.h"

namespace palpate::sensing {

/// Converts an image as a camera delivers it to the form that `Decoder` takes: 16-bit values
/// stretched so that 2^bits - 1 is full scale, and a mosaic without its hot pixels, in colour.
/// `FrameSource` does the same.
/// \param bits that 16-bit values use, in [8, 16].
/// \throws InvalidInput if it is to be a mosaic and is not, or if a value has more bits.
[[nodiscard]] cv::Mat decodable(const cv::Mat& image, std::optional<BayerPattern> bayer,
                                int bits = 16);

}  // namespace palpate::sensing
