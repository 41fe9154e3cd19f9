// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/simulated_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "capture/pixel_format.h"
#include "palpate/core/error.h"
#include "palpate/sensing/frame_source.h"

namespace palpate::sensing {
namespace {

constexpr double kUsualRate = 30;  // frames/s

/// All images are read before the first is sent, so that reading takes no processor time from the
/// program under test. [bytes]
constexpr std::size_t kMostBytes = std::size_t{2} << 30U;

std::size_t bytes_of(const cv::Mat& image) { return image.total() * image.elemSize(); }

/// The format of images, as GenICam would name it.
std::string usual_format(const cv::Mat& image) {
  if (image.channels() == 3) return "BGR8";
  return image.depth() == CV_16U ? "Mono16" : "Mono8";
}

}  // namespace

CameraClock steady_camera_clock() {
  using SteadyClock = std::chrono::steady_clock;
  return {.now =
              [] {
                return std::chrono::duration<double>(SteadyClock::now().time_since_epoch()).count();
              },
          .wait_until =
              [](double time) {
                std::this_thread::sleep_until(
                    SteadyClock::time_point(std::chrono::duration_cast<SteadyClock::duration>(
                        std::chrono::duration<double>(time))));
              }};
}

SimulatedCamera::SimulatedCamera(const std::string& name, std::vector<cv::Mat> images,
                                 const CameraSettings& settings, CameraClock clock)
    : images_(std::move(images)), clock_(std::move(clock)) {
  if (images_.empty()) throw InvalidInput(name + ": there is no image to send.");
  const cv::Mat& first = images_.front();
  for (const cv::Mat& image : images_) {
    if (image.size() == first.size() && image.type() == first.type()) continue;
    throw InvalidInput(name +
                       ": all images must have the same size and type, as those of a camera.");
  }
  if (settings.size &&
      (settings.size->width != first.cols || settings.size->height != first.rows)) {
    throw InvalidInput(fmt::format("{}: its images have {} x {} px; another size is not possible.",
                                   name, first.cols, first.rows));
  }
  const std::string format =
      settings.pixel_format.empty() ? usual_format(first) : settings.pixel_format;
  const std::optional<PixelFormat> known = pixel_format(format);
  if (!known || known->channels != first.channels() ||
      (known->bits > 8) != (first.depth() == CV_16U)) {
    // Colour in 16 bits has no name in the list, but can be sent.
    if (!settings.pixel_format.empty()) {
      throw InvalidInput(fmt::format("{}: its images are {}; they are not {}.", name,
                                     usual_format(first), format));
    }
  }
  state_ = {.name = name,
            .size = {first.cols, first.rows},
            .rate = settings.rate.value_or(kUsualRate),
            .exposure_us = settings.exposure_us,
            .gain = settings.gain,
            .pixel_format = format,
            .bayer = known ? known->bayer : std::nullopt,
            .bits = first.depth() == CV_16U && known && known->bits > 8 ? known->bits
                    : first.depth() == CV_16U                           ? 16
                                                                        : 8};
}

void SimulatedCamera::start() { begin_ = clock_.now(); }

std::optional<CameraFrame> SimulatedCamera::next(std::chrono::milliseconds wait) {
  const double now = clock_.now();
  const auto there = static_cast<std::uint64_t>((now - begin_) * state_.rate);
  if (there > kSimulatedBuffers) next_ = std::max(next_, there - kSimulatedBuffers);
  if (next_ >= there) {
    const double due = begin_ + static_cast<double>(next_ + 1) / state_.rate;
    const double end = now + std::chrono::duration<double>(wait).count();
    clock_.wait_until(std::min(due, end));
    if (due > end) return std::nullopt;
  }
  const std::uint64_t number = next_++;
  return CameraFrame{.image = images_[number % images_.size()],
                     .number = number,
                     .time = static_cast<double>(number) / state_.rate};
}

std::unique_ptr<LiveCamera> open_simulated_camera(const std::string& path,
                                                  const CameraSettings& settings) {
  const std::string name = "simulated:" + path;
  FrameSource source({path});
  std::vector<cv::Mat> images;
  std::size_t bytes = 0;
  while (auto frame = source.next()) {
    images.push_back(frame->read());
    bytes += bytes_of(images.back());
    if (bytes > kMostBytes) {
      throw InvalidInput(
          fmt::format("{}: holds more than the {} MB that a simulated camera keeps in memory; give "
                      "fewer images.",
                      name, kMostBytes >> 20U));
    }
  }
  return std::make_unique<SimulatedCamera>(name, std::move(images), settings,
                                           steady_camera_clock());
}

}  // namespace palpate::sensing
