// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/haptics/contact_motion.h"

namespace palpate::haptics {

/// Whether the tool touches the object and, if so, whether the contact holds.
enum class ContactState { free, stick, slip };

/// "free", "stick" or "slip"
[[nodiscard]] const char* to_string(ContactState state);

/// Tool position at a time.
struct TrajectoryPoint {
  double time = 0;                                 ///< [s]
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< [mm] world
};

/// Output of the haptic loop at a time.
struct TracePoint {
  double time = 0;                                 ///< [s]
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< [mm] world
  Eigen::Vector3d contact =
      Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface; free: the tool
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] on the USER: minus that on the object
  ContactState state = ContactState::free;
};

/// The state of the haptic loop between two ticks. The first tick with a new state is free,
/// wherever the tool is.
struct LoopState {
  ContactState contact_state = ContactState::free;
  bool has_proxy = false;
  /// The contact while touching; while free, its position is that of the tool at the last tick.
  TouchPoint proxy;
};

/// The result of one tick for the device.
struct Command {
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  ///< [N] on the USER, world: minus that on the object
  Eigen::Vector3d contact =
      Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface; free: the tool
  ContactState state = ContactState::free;
};

/// The haptic loop of a model (thesis 5.5.1), at 1 kHz or more.
///
/// A free tool touches when its path since the last tick enters the surface from outside. The
/// contact stays (stick) while the force lies in the friction cone and moves otherwise (slip). It
/// ends when the tool is no longer behind the surface as seen from the contact. If the force pulls
/// even at the place to which the contact slips (f_N <= 0), the contact is lost: this tick has no
/// force, and the tool touches again in the next tick if it is still behind the surface.
class Playback {
 public:
  /// Allocates everything that `step` needs.
  ///
  /// \throws InvalidInput if `check_model` throws.
  explicit Playback(const Model& model);

  /// Computes one tick. It does not allocate, lock, throw or log, and is thread-safe with one state
  /// per thread. The force is always finite. A tool position that is not finite gives no force and
  /// ends the contact.
  [[nodiscard]] Command step(const Eigen::Vector3d& tool, LoopState& state) const noexcept;

 private:
  Eigen::Matrix3Xd normals_;  // of the surface's triangles
  double offset_;             // [mm] height of a contact's viewpoint above the surface
  BlendedField field_;

  [[nodiscard]] bool touches(const LoopState& state, const Eigen::Vector3d& tool,
                             TouchPoint& contact) const noexcept;
};

/// Plays a whole trajectory, beginning with a new state.
[[nodiscard]] std::vector<TracePoint> play(const Playback& playback,
                                           std::span<const TrajectoryPoint> trajectory);

}  // namespace palpate::haptics
