// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "surfaces/motion_sequence.h"

namespace palpate::apps {

/// The frames of a sequence, of which some are in memory at a time.
class NearFrames {
 public:
  /// \param rate [1/s] of the times of frames, \param reference whose triangles all must have.
  NearFrames(const MotionSequence& sequence, const std::optional<double>& rate,
             geometry::TriangleMesh reference);

  /// Reads the frames from `begin` to before `end`. Both never decrease.
  /// \throws FileError as `read_motion_frame`.
  void load(std::size_t begin, std::size_t end);

  [[nodiscard]] const geometry::MeshFile& at(std::size_t i) const { return near_[i - first_]; }
  /// [s], or frames without a rate.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }

 private:
  const std::vector<MotionFrame>& frames_;
  geometry::TriangleMesh reference_;
  std::vector<double> times_;
  std::vector<geometry::MeshFile> near_;
  std::size_t first_ = 0;  // of `near_`
};

/// Where the vertices of a frame are, and how they move.
struct FrameMotion {
  geometry::MeshFile frame;
  std::optional<Eigen::Matrix3Xd> velocity = {};  ///< [mm/s], or mm per frame without a rate
  Eigen::VectorXd sigma = {};                     ///< [mm] of smoothed positions
};

/// By the frames before and after it.
[[nodiscard]] FrameMotion motion_between(NearFrames& near, std::size_t i);

/// Smoothed over the frames in the window (`geometry::smooth_motion`).
/// \param window in the unit of the times.
[[nodiscard]] FrameMotion smoothed_motion(NearFrames& near, std::size_t i, double window);

/// Whether the window of each frame has enough frames. Warns if some have not.
/// \param unit of the times and the window, for messages.
/// \throws InvalidInput if that of none has.
[[nodiscard]] std::vector<bool> can_be_smoothed(const std::vector<double>& times, double window,
                                                const char* unit);

}  // namespace palpate::apps
