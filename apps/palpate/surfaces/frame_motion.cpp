// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/frame_motion.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <span>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/motion_smoothing.h"

namespace palpate::apps {

NearFrames::NearFrames(const MotionSequence& sequence, const std::optional<double>& rate,
                       geometry::TriangleMesh reference)
    : frames_(sequence.frames), reference_(std::move(reference)) {
  for (const MotionFrame& frame : frames_) times_.push_back(frame.time / rate.value_or(1));
}

void NearFrames::load(std::size_t begin, std::size_t end) {
  while (first_ + near_.size() < end)
    near_.push_back(read_motion_frame(frames_[first_ + near_.size()].file, reference_));
  near_.erase(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(begin - first_));
  first_ = begin;
}

FrameMotion motion_between(NearFrames& near, std::size_t i) {
  const std::size_t begin = i > 0 ? i - 1 : 0, end = std::min(i + 2, near.times().size());
  near.load(begin, end);
  FrameMotion motion{.frame = near.at(i)};
  if (end - begin > 1) {
    motion.velocity = (near.at(end - 1).mesh.vertices - near.at(begin).mesh.vertices) /
                      (near.times()[end - 1] - near.times()[begin]);
  }
  return motion;
}

FrameMotion smoothed_motion(NearFrames& near, std::size_t i, double window) {
  const std::vector<double>& times = near.times();
  const auto begin = std::ranges::upper_bound(times, times[i] - window) - times.begin();
  const auto end = std::ranges::lower_bound(times, times[i] + window) - times.begin();
  near.load(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
  std::vector<Eigen::Matrix3Xd> positions;
  for (auto k = begin; k < end; ++k)
    positions.push_back(near.at(static_cast<std::size_t>(k)).mesh.vertices);
  geometry::SmoothedMotion smooth = geometry::smooth_motion(
      positions, std::span(times).subspan(static_cast<std::size_t>(begin), positions.size()),
      times[i], window);
  FrameMotion motion{.frame = near.at(i), .velocity = std::move(smooth.velocity)};
  motion.frame.mesh.vertices = std::move(smooth.positions);
  motion.sigma = std::move(smooth.sigma);
  return motion;
}

std::vector<bool> can_be_smoothed(const std::vector<double>& times, double window,
                                  const char* unit) {
  std::vector<bool> enough;
  for (const double time : times)
    enough.push_back(geometry::frames_in_window(times, time, window) >=
                     geometry::kFewestSmoothedFrames);
  const auto without = std::ranges::count(enough, false);
  if (without == std::ssize(enough)) {
    throw InvalidInput(
        fmt::format("--window: {} {} is too short: no window has the {} frames that a fit needs; "
                    "give a longer one (the sequence lasts {:.3g} {})",
                    window, unit, geometry::kFewestSmoothedFrames, times.back(), unit));
  }
  if (without > 0) {
    spdlog::warn(
        "{} of {} frames are not smoothed: their windows have fewer than {} frames (--window).",
        without, enough.size(), geometry::kFewestSmoothedFrames);
  }
  return enough;
}

}  // namespace palpate::apps
