// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

/// Computes the exposure, in full scales per unit of light, from the sensor's exposure settings.
/// \param light  first frame behind the lens: float, blue, green, red.
/// \param lit    pixels that count for an automatic exposure; if none, or all are black, it is 1.
[[nodiscard]] double choose_exposure(const cv::Mat& light, const PixelMask& lit,
                                     const VirtualSensor& sensor);

/// Converts light behind the lens into a frame: noise, mosaic, response, quantisation.
/// \param frame_number  determines the noise, together with the sensor's seed and the pixel.
[[nodiscard]] cv::Mat read_out(const cv::Mat& light, double exposure, const VirtualSensor& sensor,
                               std::uint64_t frame_number);

}  // namespace palpate::sensing
