// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"

namespace palpate::sensing {

/// The time that passes for a simulated camera [s].
struct CameraClock {
  std::function<double()> now;
  std::function<void(double)> wait_until;
};

/// The computer's own time.
[[nodiscard]] CameraClock steady_camera_clock();

/// Frames that a simulated camera keeps for a late reader, as the buffers of a driver do.
inline constexpr std::uint64_t kSimulatedBuffers = 4;

/// Sends images again and again, at the rate of its clock; see `open_camera`. Frame n is there
/// (n + 1) / rate after the start.
class SimulatedCamera : public LiveCamera {
 public:
  /// \param name for messages.
  /// \throws InvalidInput unless there are images, all of one size and type, or if they do not suit
  /// the settings.
  SimulatedCamera(const std::string& name, std::vector<cv::Mat> images,
                  const CameraSettings& settings, CameraClock clock);

  [[nodiscard]] const CameraState& state() const override { return state_; }
  void set_exposure(double microseconds) override { state_.exposure_us = microseconds; }
  void start() override;
  [[nodiscard]] std::optional<CameraFrame> next(std::chrono::milliseconds wait) override;

 private:
  std::vector<cv::Mat> images_;
  CameraClock clock_;
  CameraState state_;
  double begin_ = 0;
  std::uint64_t next_ = 0;  ///< number of the next frame
};

/// The camera `simulated:PATH`.
[[nodiscard]] std::unique_ptr<LiveCamera> open_simulated_camera(const std::string& path,
                                                                const CameraSettings& settings);

}  // namespace palpate::sensing
