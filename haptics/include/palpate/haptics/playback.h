// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/contact_motion.h"
#include "palpate/haptics/packed_field.h"

namespace palpate::haptics {

/// The state of a contact: the tool is free, or it touches and the contact sticks or slips.
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

/// The rule by which a slipping contact moves (thesis 5.4.2, Figure 5.6).
enum class ContactMotion {
  bracketed,         ///< to a root of |f_T| - mu f_N (Eq 5.17), found by a bracketed search
  brent,             ///< to a minimum of h(t) (Eq 5.18), found by Brent's method: `slip_contact`
  friction_boundary  ///< by the tool's motion beyond the friction boundary: `slip_by_boundary`
};

/// The meaning, unit and range of each field stand in its list, `visit`, which docs/options.md
/// shows.
struct PlaybackOptions {
  ContactMotion motion = ContactMotion::bracketed;
  std::optional<double> tolerance = std::nullopt;
  std::optional<double> energy_credit = std::nullopt;
  double unknown_friction = 0;
  std::optional<double> largest_jump = std::nullopt;
  std::optional<double> start_depth = std::nullopt;
  double longest_step = 50;
  int hold_ticks = 20;

  bool operator==(const PlaybackOptions&) const = default;
};

void visit(PlaybackOptions& options, FieldVisitor& visitor);

/// The options with all that is not set chosen for a model, in proportion to its size and to the
/// force and the depth up to which it was measured.
/// \throws InvalidInput if an option is outside its range.
[[nodiscard]] PlaybackOptions playback_options_for(const Model& model,
                                                   const PlaybackOptions& options);

/// The state of the haptic loop between two ticks, of one `Playback`; another one starts afresh.
struct LoopState {
  ContactState contact_state = ContactState::free;
  bool has_proxy = false;  ///< false before the first tick
  /// The contact while touching; while free, its position is that of the tool at the last tick.
  TouchPoint proxy;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();   ///< [mm] the last usable position
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] the last command
  /// [N] of the contact in the last tick, on the object, before limits.
  Eigen::Vector3d contact_force = Eigen::Vector3d::Zero();
  int faulty_ticks = 0;          ///< in a row until now
  double work = 0;               ///< [N mm] by the user, with the credit
  SlipMemory slip;               ///< of the last slip of this touch
  std::uint64_t playback = 0;    ///< identifies its `Playback`
  DelayedDisplacements delayed;  ///< of the contact; with a rate only
  bool has_place = false;        ///< true if `place` is that of the contact
  PlaceField place;
};

/// The result of one tick for the device.
struct Command {
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  ///< [N] on the USER, world: minus that on the object
  Eigen::Vector3d contact =
      Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface; free: the tool
  ContactState state = ContactState::free;
  bool started_inside = false;  ///< the tool was inside the object when the loop started
  bool held = false;            ///< the tool's position was not usable
  bool limited = false;         ///< by `PlaybackOptions::largest_jump`
};

/// The haptic loop of a model (thesis 5.5.1), at 1 kHz or more.
///
/// A free tool touches when its path since the last tick enters the surface from outside. The
/// contact stays (stick) while the force lies in the friction cone and moves otherwise (slip). It
/// ends when the tool is neither behind the contact's own triangle nor, where the contact lies in a
/// crease, behind the other ones there, nor behind any other part of the surface as seen from the
/// contact; or when it slips off the border. So it does if it would slip, finds no
/// place on the friction cone, and the tool is in front of the nearest part. If the force pulls at
/// the place to which the contact slips (f_N < 0), it is lost, and the tool may touch again in the
/// next tick. In all three cases a tool that has not crossed the surface, and is behind the nearest
/// part of it, up to `start_depth`, keeps a contact: at the nearest point.
class Playback {
 public:
  /// Allocates everything that `step` needs.
  ///
  /// \throws InvalidInput if `check_model` throws or an option is outside its range.
  explicit Playback(const Model& model, const PlaybackOptions& options = {});
  ~Playback();
  Playback(Playback&&) noexcept;
  Playback& operator=(Playback&&) noexcept;

  /// Computes one tick. It does not allocate, lock, throw or log, its time is bounded, and it is
  /// thread-safe with one state per thread. The force is always finite. A position that is not
  /// finite or farther away than `longest_step` is not used: see `PlaybackOptions::hold_ticks`.
  ///
  /// If the model depends on the rate (rate_law.h), a tick is a motion with the delayed
  /// displacements held, and then a rest of `seconds` in which they follow: both are passive. They
  /// move along with the contact. If the object would pull the tool, because the tool returns
  /// faster than it, they follow at once as far as needed, which only loses energy.
  /// \param seconds since the last tick, or 1 kHz's; used only if the model depends on the rate
  [[nodiscard]] Command step(const Eigen::Vector3d& tool, LoopState& state,
                             double seconds = 1e-3) const noexcept;

  struct Ball {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [mm]
    double radius = 0;                                 ///< [mm]
  };
  /// About the surface and `start_depth` around it: outside, a tool is free wherever it comes from.
  [[nodiscard]] const Ball& reach() const noexcept;

  /// Number of contacts that have `PlaybackOptions::unknown_friction`.
  [[nodiscard]] int unknown_friction_count() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Plays a whole trajectory, beginning with a new state. The durations of ticks follow its times.
[[nodiscard]] std::vector<TracePoint> play(const Playback& playback,
                                           std::span<const TrajectoryPoint> trajectory);

}  // namespace palpate::haptics
