// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

/// Full scales per unit of light: as the sensor's exposure says.
/// \param light  of the first frame behind the lens: float, blue, green, red.
/// \param lit    the pixels that count for an exposure of its own; without any, or all black, 1.
[[nodiscard]] double choose_exposure(const cv::Mat& light, const PixelMask& lit,
                                     const VirtualSensor& sensor);

/// The frame that light behind the lens becomes: noise, mosaic, response, whole numbers.
/// \param frame_number  with the sensor's seed and the pixel's place it determines the noise.
[[nodiscard]] cv::Mat read_out(const cv::Mat& light, double exposure, const VirtualSensor& sensor,
                               std::uint64_t frame_number);

}  // namespace palpate::sensing
