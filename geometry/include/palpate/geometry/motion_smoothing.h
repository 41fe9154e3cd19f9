// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// Vertices at one time, smoothed over the frames around it.
struct SmoothedMotion {
  Eigen::Matrix3Xd positions;  ///< [mm] 3 x V
  Eigen::Matrix3Xd velocity;   ///< [mm/s] 3 x V
  /// [mm] V; standard deviation of each coordinate of a position, by the scatter of the frames
  /// around it. It holds if the errors of the frames are independent; motion that the window is too
  /// long for makes it larger.
  Eigen::VectorXd sigma;
};

/// Fewest frames in a window: three for the parabola, and one for its deviation.
inline constexpr int kFewestSmoothedFrames = 4;

/// The number of frames that `smooth_motion` takes into account.
[[nodiscard]] int frames_in_window(std::span<const double> times, double time, double window);

/// Smooths the motion of vertices without lag. A parabola in time is fitted to each coordinate of a
/// vertex in the frames that are less than `window` before or after `time`, with weights
/// (1 - (|t - time| / window)^3)^3 (local regression: Cleveland, J. Am. Stat. Assoc. 74, 1979);
/// weights below 1e-4 count as 0. Its value at `time` is the position, its slope the velocity.
/// Frames may be missing.
/// \param frames [mm] 3 x V each; vertices in frames of the same surface.
/// \param times [s] of the frames, ascending.
/// \param window [s] > 0.
/// \throws InvalidInput if fewer than `kFewestSmoothedFrames` are in the window, the frames differ
/// in size, their number is not that of the times, a time or a position of a frame in the window is
/// not finite, or times do not ascend.
[[nodiscard]] SmoothedMotion smooth_motion(std::span<const Eigen::Matrix3Xd> frames,
                                           std::span<const double> times, double time,
                                           double window);

}  // namespace palpate::geometry
