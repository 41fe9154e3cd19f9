// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/haptics/contact_motion.h"
#include "palpate/haptics/trajectory_csv.h"

namespace palpate::haptics {

/// What one tick of the haptic loop remembers for the next. A new one knows nothing: its first tick
/// is free wherever the tool is.
struct LoopState {
  ContactState contact_state = ContactState::free;
  bool has_proxy = false;
  /// Touching: the contact. Free: position is the tool at the last tick.
  TouchPoint proxy;
};

/// What one tick tells the device.
struct Command {
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  ///< [N] on the USER, world: minus that on the object
  Eigen::Vector3d contact =
      Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface; free: the tool
  ContactState state = ContactState::free;
};

/// The haptic loop of a model (thesis 5.5.1), at 1 kHz or more.
///
/// Free, the tool touches when its way since the last tick enters the surface from outside.
/// Touching, the contact stays (stick) while the force lies in the friction cone, else moves
/// (slip); it ends when the tool is no longer behind the surface, seen from the contact. If the
/// force pulls even where the contact slips to (f_N <= 0) the contact is lost: no force in this
/// tick, and the tool touches anew in the next if it is still behind the surface.
class Playback {
 public:
  /// Everything that allocates happens here.
  /// \throws InvalidInput if `check_model` refuses.
  explicit Playback(const Model& model);

  /// One tick. Does not allocate, lock, throw or log; thread-safe with one state a thread. A tool
  /// position that is not finite gives no force and forgets the contact. The force is always
  /// finite.
  [[nodiscard]] Command step(const Eigen::Vector3d& tool, LoopState& state) const noexcept;

 private:
  Eigen::Matrix3Xd normals_;  // of the surface's triangles
  double offset_;             // [mm] from which a contact looks at the tool, outside the surface
  BlendedField field_;

  [[nodiscard]] bool touches(const LoopState& state, const Eigen::Vector3d& tool,
                             TouchPoint& contact) const noexcept;
};

/// Plays a whole trajectory from a new state.
[[nodiscard]] std::vector<TracePoint> play(const Playback& playback,
                                           std::span<const TrajectoryPoint> trajectory);

}  // namespace palpate::haptics
