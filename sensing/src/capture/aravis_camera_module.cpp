// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `aravis_camera`.
#include <arv.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "capture/aravis_camera.h"
#include "capture/frame_numbers.h"
#include "capture/pixel_format.h"
#include "palpate/core/error.h"

namespace {

using palpate::DeviceError;
using palpate::InvalidInput;
using palpate::sensing::CameraEntry;
using palpate::sensing::CameraFrame;
using palpate::sensing::CameraSettings;
using palpate::sensing::CameraState;
using palpate::sensing::PixelFormat;

/// Frames that wait in the driver until they are taken. With fewer, a reader that pauses for
/// some 0.1 s loses frames of fast cameras.
constexpr int kBuffers = 32;

constexpr double kNanoseconds = 1e9;  ///< in a second

/// Aravis' own simulation is listed only if it is asked for by name.
constexpr const char* kFake = "Fake";

/// Cameras round requested values to whole steps of their clock: a value that differs by no more
/// counts as the requested one.
constexpr double kSameValue = 0.01;

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref>;

/// The error report of a call to Aravis.
class Report {
 public:
  Report() = default;
  ~Report() { g_clear_error(&error_); }
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  operator GError**() { return &error_; }
  /// \throws DeviceError if the call failed.
  void check(const std::string& camera, const char* what) const {
    if (error_ == nullptr) return;
    throw DeviceError(fmt::format("{}: {}: {}.", camera, what, error_->message));
  }

 private:
  GError* error_ = nullptr;
};

/// Calls a function of Aravis that takes a GError** last.
template <typename Function, typename... Arguments>
auto asked(const std::string& camera, const char* what, Function function, Arguments... arguments) {
  Report report;
  if constexpr (std::is_void_v<decltype(function(arguments..., report))>) {
    function(arguments..., report);
    report.check(camera, what);
  } else {
    auto answer = function(arguments..., report);
    report.check(camera, what);
    return answer;
  }
}

std::string text_or(const char* text, const char* otherwise) {
  return text != nullptr ? text : otherwise;
}

std::string there_are() {
  arv_update_device_list();
  std::string names;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i)
    names += (names.empty() ? "" : ", ") + text_or(arv_get_device_id(i), "?");
  return names.empty() ? "no GenICam camera was found" : "there are " + names;
}

class AravisCamera : public palpate::sensing::LiveCamera {
 public:
  AravisCamera(const std::string& name, const CameraSettings& settings);
  ~AravisCamera() override;

  [[nodiscard]] const CameraState& state() const override { return state_; }
  void set_exposure(double microseconds) override;
  void start() override;
  [[nodiscard]] std::optional<CameraFrame> next(std::chrono::milliseconds wait) override;

 private:
  void set_pixel_format(const std::string& name);
  void set_size(const palpate::sensing::ImageSize& size);
  void set_rate(double rate);
  void set_gain(double gain);
  void check_value(const char* what, double wanted, double has, std::pair<double, double> bounds);
  [[nodiscard]] cv::Mat image_of(ArvBuffer* buffer) const;

  CameraState state_;
  PixelFormat format_;
  Owned<ArvCamera> camera_;
  Owned<ArvStream> stream_;
  std::atomic<bool> gone_ = false;
  palpate::sensing::NumbersByCounter numbers_;
  std::optional<guint64> begin_;  ///< ns
};

void on_control_lost(ArvDevice* /*device*/, gpointer gone) {
  static_cast<std::atomic<bool>*>(gone)->store(true);
}

AravisCamera::AravisCamera(const std::string& name, const CameraSettings& settings) {
  state_.name = "aravis:" + name;
  if (name.starts_with(kFake)) arv_enable_interface(kFake);
  Report report;
  camera_.reset(arv_camera_new(name.c_str(), report));
  if (!camera_) {
    throw InvalidInput(state_.name + ": cannot be opened; " + there_are() +
                       ". Is it plugged in, in the same network, and not used by another program?");
  }
  ArvCamera* const camera = camera_.get();
  state_.name += fmt::format(
      " ({} {})",
      text_or(asked(state_.name, "its maker", arv_camera_get_vendor_name, camera), "unknown maker"),
      text_or(asked(state_.name, "its model", arv_camera_get_model_name, camera), "unknown model"));
  g_signal_connect(arv_camera_get_device(camera), "control-lost", G_CALLBACK(on_control_lost),
                   &gone_);
  set_pixel_format(settings.pixel_format);
  if (settings.size) set_size(*settings.size);
  if (settings.rate) set_rate(*settings.rate);
  if (settings.exposure_us) set_exposure(*settings.exposure_us);
  if (settings.gain) set_gain(*settings.gain);
  asked(state_.name, "the mode of acquisition", arv_camera_set_acquisition_mode, camera,
        ARV_ACQUISITION_MODE_CONTINUOUS);
  gint x = 0, y = 0;
  asked(state_.name, "its size", arv_camera_get_region, camera, &x, &y, &state_.size.width,
        &state_.size.height);
  Report unknown;  // not every camera reports its rate
  state_.rate = std::max(arv_camera_get_frame_rate(camera, unknown), 0.0);
  if (arv_camera_is_exposure_time_available(camera, nullptr) != 0)
    state_.exposure_us = arv_camera_get_exposure_time(camera, nullptr);
  if (arv_camera_is_gain_available(camera, nullptr) != 0)
    state_.gain = arv_camera_get_gain(camera, nullptr);
}

AravisCamera::~AravisCamera() {
  if (stream_) arv_camera_stop_acquisition(camera_.get(), nullptr);
  g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera_.get()), &gone_);
}

/// \throws InvalidInput if the camera rounded the requested value to something else.
void AravisCamera::check_value(const char* what, double wanted, double has,
                               std::pair<double, double> bounds) {
  if (std::abs(has - wanted) <= kSameValue * std::abs(wanted)) return;
  throw InvalidInput(fmt::format("{}: {} is {:g}; the camera offers {:g} to {:g}, and took {:g}.",
                                 state_.name, what, wanted, bounds.first, bounds.second, has));
}

void AravisCamera::set_pixel_format(const std::string& name) {
  ArvCamera* const camera = camera_.get();
  guint count = 0;
  const std::unique_ptr<const char*, decltype(&g_free)> names(
      asked(state_.name, "its pixel formats", arv_camera_dup_available_pixel_formats_as_strings,
            camera, &count),
      &g_free);
  std::string offered;
  bool has = name.empty();
  for (guint i = 0; i < count; ++i) {
    offered += (offered.empty() ? "" : ", ") + std::string(names.get()[i]);
    has = has || name == names.get()[i];
  }
  if (!has) {
    throw InvalidInput(state_.name + ": has no pixel format " + name + "; it offers " + offered +
                       ".");
  }
  if (!name.empty())
    asked(state_.name, "the pixel format", arv_camera_set_pixel_format_from_string, camera,
          name.c_str());
  state_.pixel_format = text_or(
      asked(state_.name, "its pixel format", arv_camera_get_pixel_format_as_string, camera), "");
  const auto known = palpate::sensing::pixel_format(state_.pixel_format);
  if (!known) {
    throw InvalidInput(state_.name + ": the pixel format " + state_.pixel_format +
                       " is not read; choose one of " + palpate::sensing::known_pixel_formats() +
                       ". The camera offers " + offered + ".");
  }
  format_ = *known;
  state_.bayer = format_.bayer;
  state_.bits = format_.bits;
}

void AravisCamera::set_size(const palpate::sensing::ImageSize& size) {
  ArvCamera* const camera = camera_.get();
  gint width[2] = {}, height[2] = {};
  asked(state_.name, "its widths", arv_camera_get_width_bounds, camera, width, width + 1);
  asked(state_.name, "its heights", arv_camera_get_height_bounds, camera, height, height + 1);
  const auto refuse = [&](gint has_width, gint has_height) {
    throw InvalidInput(fmt::format(
        "{}: the size is {} x {} px; the camera offers {} x {} to {} x {} px{}.", state_.name,
        size.width, size.height, width[0], height[0], width[1], height[1],
        has_width > 0 ? fmt::format(", and took {} x {} px", has_width, has_height) : ""));
  };
  if (size.width < width[0] || size.width > width[1] || size.height < height[0] ||
      size.height > height[1])
    refuse(0, 0);
  asked(state_.name, "the size", arv_camera_set_region, camera, 0, 0, size.width, size.height);
  gint x = 0, y = 0, has_width = 0, has_height = 0;
  asked(state_.name, "its size", arv_camera_get_region, camera, &x, &y, &has_width, &has_height);
  if (has_width != size.width || has_height != size.height) refuse(has_width, has_height);
}

void AravisCamera::set_rate(double rate) {
  ArvCamera* const camera = camera_.get();
  std::pair<double, double> bounds;
  asked(state_.name, "its rates", arv_camera_get_frame_rate_bounds, camera, &bounds.first,
        &bounds.second);
  asked(state_.name, "the rate", arv_camera_set_frame_rate, camera, rate);
  check_value("the rate [frames/s]", rate,
              asked(state_.name, "its rate", arv_camera_get_frame_rate, camera), bounds);
}

void AravisCamera::set_exposure(double microseconds) {
  ArvCamera* const camera = camera_.get();
  if (arv_camera_is_exposure_auto_available(camera, nullptr) != 0)
    asked(state_.name, "exposure by hand", arv_camera_set_exposure_time_auto, camera, ARV_AUTO_OFF);
  std::pair<double, double> bounds;
  asked(state_.name, "its exposures", arv_camera_get_exposure_time_bounds, camera, &bounds.first,
        &bounds.second);
  asked(state_.name, "the exposure", arv_camera_set_exposure_time, camera, microseconds);
  state_.exposure_us = asked(state_.name, "its exposure", arv_camera_get_exposure_time, camera);
  check_value("the exposure [us]", microseconds, *state_.exposure_us, bounds);
}

void AravisCamera::set_gain(double gain) {
  ArvCamera* const camera = camera_.get();
  if (arv_camera_is_gain_auto_available(camera, nullptr) != 0)
    asked(state_.name, "gain by hand", arv_camera_set_gain_auto, camera, ARV_AUTO_OFF);
  std::pair<double, double> bounds;
  asked(state_.name, "its gains", arv_camera_get_gain_bounds, camera, &bounds.first,
        &bounds.second);
  asked(state_.name, "the gain", arv_camera_set_gain, camera, gain);
  check_value("the gain", gain, asked(state_.name, "its gain", arv_camera_get_gain, camera),
              bounds);
}

void AravisCamera::start() {
  ArvCamera* const camera = camera_.get();
  stream_.reset(asked(state_.name, "its stream", arv_camera_create_stream, camera,
                      static_cast<ArvStreamCallback>(nullptr), static_cast<void*>(nullptr)));
  if (!stream_) throw DeviceError(state_.name + ": the camera gives no stream of frames.");
  const guint bytes = asked(state_.name, "the size of a frame", arv_camera_get_payload, camera);
  for (int i = 0; i < kBuffers; ++i)
    arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(bytes));
  asked(state_.name, "the start", arv_camera_start_acquisition, camera);
}

cv::Mat AravisCamera::image_of(ArvBuffer* buffer) const {
  gint x = 0, y = 0, width = 0, height = 0, padding = 0, rows_after = 0;
  arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
  arv_buffer_get_image_padding(buffer, &padding, &rows_after);
  std::size_t bytes = 0;
  const void* const data = arv_buffer_get_image_data(buffer, &bytes);
  const int type = CV_MAKETYPE(format_.bits > 8 ? CV_16U : CV_8U, format_.channels);
  const std::size_t step = static_cast<std::size_t>(width) * CV_ELEM_SIZE(type) +
                           static_cast<std::size_t>(std::max(padding, 0));
  if (data == nullptr || width != state_.size.width || height != state_.size.height ||
      bytes < step * static_cast<std::size_t>(height)) {
    throw DeviceError(fmt::format(
        "{}: sent a frame of {} x {} px in {} bytes; {} x {} px of {} were expected.", state_.name,
        width, height, bytes, state_.size.width, state_.size.height, state_.pixel_format));
  }
  const cv::Mat view(height, width, type, const_cast<void*>(data), step);
  if (!format_.red_first) return view.clone();
  cv::Mat image;
  cv::cvtColor(view, image, cv::COLOR_RGB2BGR);
  return image;
}

std::optional<CameraFrame> AravisCamera::next(std::chrono::milliseconds wait) {
  if (gone_) throw DeviceError(state_.name + ": the camera no longer answers; it may be unplugged");
  using std::chrono::microseconds;
  ArvBuffer* const buffer = arv_stream_timeout_pop_buffer(
      stream_.get(), static_cast<guint64>(std::chrono::duration_cast<microseconds>(wait).count()));
  if (buffer == nullptr) return std::nullopt;
  const std::unique_ptr<ArvBuffer, std::function<void(ArvBuffer*)>> back(
      buffer, [&](ArvBuffer* used) { arv_stream_push_buffer(stream_.get(), used); });
  // A frame of which packets are missing leaves a gap in the numbers.
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return std::nullopt;
  const guint64 stamp = arv_buffer_get_timestamp(buffer);
  const guint64 time = stamp != 0 ? stamp : arv_buffer_get_system_timestamp(buffer);
  if (!begin_) begin_ = time;
  return CameraFrame{
      .image = image_of(buffer),
      .number = numbers_.next(arv_buffer_get_frame_id(buffer)),
      .time = (static_cast<double>(time) - static_cast<double>(*begin_)) / kNanoseconds};
}

std::unique_ptr<palpate::sensing::LiveCamera> open(const std::string& name,
                                                   const CameraSettings& settings) {
  return std::make_unique<AravisCamera>(name, settings);
}

std::vector<CameraEntry> list() {
  arv_update_device_list();
  std::vector<CameraEntry> entries;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    entries.push_back({.name = "aravis:" + text_or(arv_get_device_id(i), "?"),
                       .model = text_or(arv_get_device_vendor(i), "unknown maker") + " " +
                                text_or(arv_get_device_model(i), "unknown model")});
  }
  return entries;
}

}  // namespace

const palpate::sensing::AravisCameras palpate_aravis_camera{&open, &list};
