// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"

namespace palpate::sensing {

/// The camera `v4l2:NUMBER`, through OpenCV.
[[nodiscard]] std::unique_ptr<LiveCamera> open_v4l2_camera(const std::string& number,
                                                           const CameraSettings& settings);

/// The devices of V4L2, with the names that the kernel gives them.
/// \param classes the folder in which the kernel lists them.
[[nodiscard]] std::vector<CameraEntry> list_v4l2_cameras(
    const std::filesystem::path& classes = "/sys/class/video4linux");

}  // namespace palpate::sensing
