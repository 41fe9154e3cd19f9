// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/v4l2_camera.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "capture/frame_numbers.h"
#include "files/storage_file.h"
#include "files/video_capture.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/module.h"

namespace palpate::sensing {
namespace {

/// V4L2 counts exposures in units of 100 us, and its value for manual exposure is 1.
constexpr double kExposureUnit = 100;
constexpr double kByHand = 1;

/// V4L2's name for images with lossy compression.
constexpr std::string_view kMotionJpeg = "MJPG";
/// Images whose colours have half the resolution of their brightness.
constexpr std::array<std::string_view, 6> kCoarseColors{"YUYV", "UYVY", "YU12",
                                                        "YV12", "NV12", "NV21"};

/// The letters of a format, of which V4L2 makes one number, the first one lowest.
std::string letters_of(int format) {
  std::string letters;
  for (int i = 0; i < 4; ++i) letters.push_back(static_cast<char>(format >> (8 * i) & 0xff));
  return letters;
}

/// A rate that differs by no more counts as the requested one.
constexpr double kSameRate = 0.01;

DeviceCapture open_device(int number) {
  static const void* const captures = module_symbol("video_capture");
  return static_cast<const VideoCaptures*>(captures)->open_device(number);
}

std::string there_are() {
  std::string names;
  for (const CameraEntry& entry : list_v4l2_cameras())
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", entry.name, entry.model);
  return names.empty() ? "there is no camera of V4L2" : "there are " + names;
}

/// \throws InvalidInput or DeviceError that says why the device cannot be used.
int number_of_device(const std::string& text) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) {
    throw InvalidInput("v4l2:" + text + ": is no number of a device; " + there_are() + ".");
  }
  const std::string device = "/dev/video" + std::to_string(number);
  if (::access(device.c_str(), F_OK) != 0) {
    throw InvalidInput("v4l2:" + text + ": there is no " + device + "; " + there_are() + ".");
  }
  if (::access(device.c_str(), R_OK | W_OK) != 0) {
    throw DeviceError("v4l2:" + text + ": " + device +
                      " may not be used: " + std::generic_category().message(errno) +
                      ". Add the user to the group that owns it, mostly \"video\".");
  }
  return number;
}

class V4l2Camera : public LiveCamera {
 public:
  V4l2Camera(const std::string& number, const CameraSettings& settings);

  [[nodiscard]] const CameraState& state() const override { return state_; }
  void set_exposure(double microseconds) override;
  void start() override {}  // with its first frame
  [[nodiscard]] std::optional<CameraFrame> next(std::chrono::milliseconds wait) override;

 private:
  void ask(int property, double value, const char* what, double tolerance);
  void check(int property, double value, const char* what, double tolerance) const;

  CameraState state_;
  DeviceCapture device_;
  std::optional<NumbersByTime> numbers_;
  double begin_ = 0;  // s
};

V4l2Camera::V4l2Camera(const std::string& number, const CameraSettings& settings) {
  state_.name = "v4l2:" + number;
  if (!settings.pixel_format.empty() && settings.pixel_format != "BGR8") {
    throw InvalidInput(state_.name + ": --pixel-format is " + settings.pixel_format +
                       "; through V4L2 images are BGR8. For raw mosaics use a GenICam camera "
                       "(aravis:NAME).");
  }
  const int device = number_of_device(number);
  const QuietOpenCv quiet;
  device_ = open_device(device);
  if (!device_.set) {
    throw DeviceError(state_.name +
                      ": cannot be opened as a camera; another program may be using it, or it is "
                      "an output.");
  }
  if (settings.size) {
    // OpenCV sets the width together with the height.
    device_.set(cv::CAP_PROP_FRAME_WIDTH, settings.size->width);
    device_.set(cv::CAP_PROP_FRAME_HEIGHT, settings.size->height);
    check(cv::CAP_PROP_FRAME_WIDTH, settings.size->width, "width [px]", 0);
    check(cv::CAP_PROP_FRAME_HEIGHT, settings.size->height, "height [px]", 0);
  }
  if (settings.rate) ask(cv::CAP_PROP_FPS, *settings.rate, "rate [frames/s]", kSameRate);
  if (settings.exposure_us) set_exposure(*settings.exposure_us);
  if (settings.gain) ask(cv::CAP_PROP_GAIN, *settings.gain, "gain", 0);
  const auto property = [&](int which) { return device_.capture.property(which); };
  state_.size = {static_cast<int>(property(cv::CAP_PROP_FRAME_WIDTH)),
                 static_cast<int>(property(cv::CAP_PROP_FRAME_HEIGHT))};
  state_.rate = std::max(property(cv::CAP_PROP_FPS), 0.0);
  state_.gain = settings.gain;
  state_.pixel_format = "BGR8";
  state_.counts_frames = false;
  const std::string sent = letters_of(static_cast<int>(property(cv::CAP_PROP_FOURCC)));
  if (sent == kMotionJpeg) {
    state_.warnings.push_back(state_.name + ": compresses its images with losses (" + sent +
                              "); stripe colours and phase suffer. A smaller size or rate may "
                              "come without");
  } else if (std::ranges::find(kCoarseColors, sent) != kCoarseColors.end()) {
    state_.warnings.push_back(state_.name + ": sends colours at half the resolution (" + sent +
                              "); stripe colours and phase suffer");
  }
}

void V4l2Camera::ask(int property, double value, const char* what, double tolerance) {
  device_.set(property, value);
  check(property, value, what, tolerance);
}

/// \throws InvalidInput unless the device has the value.
void V4l2Camera::check(int property, double value, const char* what, double tolerance) const {
  const double has = device_.capture.property(property);
  if (std::abs(has - value) <= tolerance * std::abs(value)) return;
  throw InvalidInput(fmt::format("{}: does not offer the {} {:g}; the nearest is {:g}.",
                                 state_.name, what, value, has));
}

void V4l2Camera::set_exposure(double microseconds) {
  const QuietOpenCv quiet;
  device_.set(cv::CAP_PROP_AUTO_EXPOSURE, kByHand);
  ask(cv::CAP_PROP_EXPOSURE, std::round(microseconds / kExposureUnit), "exposure [100 us]", 0);
  state_.exposure_us = kExposureUnit * std::round(microseconds / kExposureUnit);
}

std::optional<CameraFrame> V4l2Camera::next(std::chrono::milliseconds wait) {
  const QuietOpenCv quiet;
  cv::Mat image;
  try {
    if (!device_.wait(wait)) return std::nullopt;
    (void)device_.capture.read(image);
  } catch (const cv::Exception&) {  // one of OpenCV's assertions
    image.release();
  }
  if (image.empty())
    throw DeviceError(state_.name + ": the camera no longer sends frames; it may be unplugged");
  const double time = device_.capture.property(cv::CAP_PROP_POS_MSEC) / 1000;
  if (!numbers_) {
    numbers_.emplace(state_.rate);
    begin_ = time;
  }
  return CameraFrame{.image = image.clone(), .number = numbers_->next(time), .time = time - begin_};
}

}  // namespace

std::unique_ptr<LiveCamera> open_v4l2_camera(const std::string& number,
                                             const CameraSettings& settings) {
  return std::make_unique<V4l2Camera>(number, settings);
}

std::vector<CameraEntry> list_v4l2_cameras(const std::filesystem::path& classes) {
  std::vector<CameraEntry> entries;
  constexpr std::string_view kStart = "video";
  std::error_code none;
  std::vector<std::filesystem::path> devices;
  for (const auto& entry : std::filesystem::directory_iterator(classes, none)) {
    if (entry.path().filename().string().starts_with(kStart)) devices.push_back(entry.path());
  }
  std::sort(devices.begin(), devices.end(), comes_before);
  for (const std::filesystem::path& device : devices) {
    std::string model;
    std::ifstream stream(device / "name");
    std::getline(stream, model);
    entries.push_back(
        {.name = "v4l2:" + device.filename().string().substr(kStart.size()), .model = model});
  }
  return entries;
}

}  // namespace palpate::sensing
