// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "palpate/acquisition/rest_camera.h"
#include "palpate/acquisition/tool_shape.h"
#include "palpate/probing/specimen.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::acquisition {

/// What stands before a specimen.
struct VirtualCameraSetup {
  sensing::Rig rig;
  sensing::Pattern pattern;
  cv::Mat panel;  ///< what the projector shows: the image of the pattern
  sensing::VirtualSensor sensor;
  ToolShape tool;
  double object_reflectance = 0.8, tool_reflectance = 0.5;  ///< in [0, 1]
};

/// A camera that renders a specimen as the true load of a simulated arm deforms it, with the tool
/// in the picture, by the virtual sensor. The deformed object is `Specimen::deformed_surface`, an
/// equilibrium: what of a retarded object has not come yet, is seen as if it had. The noise of a
/// picture with n frames is that of the frames n times the number of the trial, and following ones.
/// \throws InvalidInput if no shape is known of the specimen, or as `sensing::simulate`.
[[nodiscard]] std::unique_ptr<RestCamera> make_virtual_camera(
    std::shared_ptr<const probing::Specimen> specimen, VirtualCameraSetup setup);

}  // namespace palpate::acquisition
