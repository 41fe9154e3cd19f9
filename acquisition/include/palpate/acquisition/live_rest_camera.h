// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "palpate/acquisition/rest_camera.h"
#include "palpate/sensing/live_camera.h"

namespace palpate::acquisition {

/// A connected camera that looks at the object of an arm. The camera sends frames all the time; a
/// picture consists of consecutive frames that were exposed after the call
/// (`sensing::take_fresh`). Mosaics are converted to colour, and more than 8 bits to 16.
/// \param camera not started yet. \param patience [s] without a frame, after which the camera
/// counts as dead; > 0.
/// \throws InvalidInput if `patience` is outside its range; DeviceError if the camera does not
/// start.
[[nodiscard]] std::unique_ptr<RestCamera> make_live_rest_camera(
    std::unique_ptr<sensing::LiveCamera> camera, double patience);

}  // namespace palpate::acquisition
