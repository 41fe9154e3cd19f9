// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "palpate/acquisition/tool_shape.h"
#include "palpate/geometry/range_map.h"
#include "palpate/probing/prober.h"

namespace palpate::acquisition {

/// A tip at rest on an object, in the frame of the camera, which is that of plans.
struct Rest {
  long long trial = 0;
  ToolPose tool = {};  ///< as the arm knows it
  /// Of a simulated arm: for a simulated camera, and nobody else.
  std::optional<probing::TrueLoad> truth = {};
  int frames = 1;  ///< to take, >= 1
};

struct RestPicture {
  cv::Mat frame;  ///< the mean of the frames that were taken, as `sensing::Decoder` takes it
  /// The true depths of the object, NaN where the tool hides it: of a simulated camera.
  std::optional<geometry::RangeMap> truth = {};
};

/// A camera, real or simulated, that takes frames while a tip rests.
class RestCamera {
 public:
  virtual ~RestCamera() = default;
  /// \throws SolverError if a simulated object has no shape under this load.
  /// \throws DeviceError if a real camera is gone, or sends something that is not a frame.
  [[nodiscard]] virtual RestPicture look(const Rest& rest) = 0;
};

}  // namespace palpate::acquisition
