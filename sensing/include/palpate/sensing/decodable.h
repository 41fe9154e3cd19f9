// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "palpate/sensing/bayer.h"

namespace palpate::sensing {

/// An image as a camera delivers it, in the form that `Decoder` takes: a mosaic without its hot
/// pixels, in colour; any other as it is. `FrameSource` does the same.
/// \throws InvalidInput if it is to be a mosaic and is not.
[[nodiscard]] cv::Mat decodable(const cv::Mat& image, std::optional<BayerPattern> bayer);

}  // namespace palpate::sensing
