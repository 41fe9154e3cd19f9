// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// The shape of a path between one of its points and the next.
enum class PathShape {
  linear,  ///< straight at constant speed: a recording
  smooth   ///< straight and at rest in each point, with the least jerk: a hand (Flash, Hogan)
};

/// A path through points at their times. Before the first and after the last it stands still.
class TimedPath {
 public:
  /// \throws InvalidInput without points, with one that is not finite, or with times that do not
  /// increase.
  explicit TimedPath(std::vector<TrajectoryPoint> points, PathShape shape = PathShape::linear);

  /// [mm] At `time` [s] after the first point. Real-time safe.
  [[nodiscard]] Eigen::Vector3d position(double time) const noexcept;
  /// [s] The time of the first point.
  [[nodiscard]] double begin() const noexcept { return points_.front().time; }
  /// [s] From the first point to the last.
  [[nodiscard]] double duration() const noexcept;

 private:
  std::vector<TrajectoryPoint> points_;
  PathShape shape_;
};

}  // namespace palpate::haptics
