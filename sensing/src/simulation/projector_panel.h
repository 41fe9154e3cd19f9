// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

/// The light of the projector's panel after the lens blur: float, blue, green, red; white is 1.
/// \throws InvalidInput, beginning with `what`, unless the image has the projector's size and a
/// type that `simulate` takes, with values in [0, 1].
[[nodiscard]] cv::Mat panel_light(const cv::Mat& image, const geometry::Camera& projector,
                                  const VirtualSensor& sensor, const std::string& what);

/// Light of one channel (0 is blue) at a place of the panel [px], interpolated bilinearly. The
/// outermost half pixels repeat the nearest centres. Precondition: the place is on the panel.
[[nodiscard]] float light_at(const cv::Mat& light, const Eigen::Vector2d& pixel, int channel);

}  // namespace palpate::sensing
