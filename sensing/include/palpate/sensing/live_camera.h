// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/sensing/bayer.h"
#include "palpate/sensing/image_size.h"

namespace palpate::sensing {

/// A frame as a camera sent it.
struct CameraFrame {
  cv::Mat image;  ///< 8 or 16 bit; grey, a mosaic, or BGR. It does not change afterwards.
  /// Position among all frames that the camera took, from 0: if numbers are missing, frames were
  /// lost.
  std::uint64_t number = 0;
  double time = 0;  ///< s since the first frame, by the camera's clock
};

/// Settings to request from a camera. Those that are not given stay unchanged. The meaning, unit
/// and range of the numbers stand in their list, `visit`.
struct CameraSettings {
  std::optional<ImageSize> size = {};
  std::optional<double> rate = {};
  std::optional<double> exposure_us = {};
  std::optional<double> gain = {};
  /// As GenICam names it: Mono8, BayerRG8, BayerRG12, RGB8; empty for the camera's own choice.
  std::string pixel_format = {};
};

void visit(CameraSettings& settings, FieldVisitor& visitor);

/// Name, format and current settings of a camera.
struct CameraState {
  std::string name;  ///< for messages: "aravis:Fake_1 (Aravis Fake)"
  ImageSize size;
  double rate = 0;  ///< frames/s; 0 if it is not known
  std::optional<double> exposure_us = {};
  std::optional<double> gain = {};
  std::string pixel_format;                ///< as above
  std::optional<BayerPattern> bayer = {};  ///< if its images are mosaics
  int bits = 8;                            ///< 2^bits - 1 is full scale; above 8 in 16-bit images
  bool counts_frames = true;               ///< false: `CameraFrame::number` comes from the times
  std::vector<std::string> warnings = {};  ///< such as compression with losses
};

/// A camera that sends frames at its own pace, whether or not they are taken. Only one thread may
/// use it at a time.
class LiveCamera {
 public:
  LiveCamera() = default;
  virtual ~LiveCamera() = default;
  LiveCamera(const LiveCamera&) = delete;
  LiveCamera& operator=(const LiveCamera&) = delete;

  [[nodiscard]] virtual const CameraState& state() const = 0;
  /// Changes the time of exposure [us], for the frames exposed after this call.
  /// \throws InvalidInput if the camera does not offer it; DeviceError if it does not answer.
  virtual void set_exposure(double microseconds) = 0;
  /// Starts sending frames. To be called once.
  /// \throws DeviceError.
  virtual void start() = 0;
  /// The oldest frame that was not taken yet; waits for it at most `wait`.
  /// \pre `start` was called.
  /// \return empty if there is none.
  /// \throws DeviceError if the camera is gone, or sends something that is not a frame.
  [[nodiscard]] virtual std::optional<CameraFrame> next(std::chrono::milliseconds wait) = 0;
};

/// Opens a camera by its name.
///
///     aravis:NAME       GenICam (GigE Vision, USB3 Vision) by Aravis; NAME is one that
///                       `list_cameras` returns, or an address. `aravis:Fake_1` is Aravis' own
///                       simulation.
///     v4l2:NUMBER       /dev/videoNUMBER, by OpenCV. It has no counter of frames.
///     simulated:PATH    plays the images of a folder or a video again and again, at 30 frames/s
///                       or the rate asked for. It keeps the last four frames for a late reader,
///                       and loses older ones.
///
/// \throws InvalidInput if there is no such kind of camera, or it does not offer these settings;
/// the message lists those that it offers.
/// \throws DeviceError if the camera cannot be opened.
[[nodiscard]] std::unique_ptr<LiveCamera> open_camera(const std::string& name,
                                                      const CameraSettings& settings = {});

/// A camera that is connected.
struct CameraEntry {
  std::string name;   ///< for `open_camera`
  std::string model;  ///< maker and model
};

/// The cameras that were found, and the errors of searches that failed.
struct CameraList {
  std::vector<CameraEntry> cameras;
  std::vector<std::string> problems;
};

/// Lists the cameras that are connected: GenICam first, then V4L2.
[[nodiscard]] CameraList list_cameras();

}  // namespace palpate::sensing
