// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/contact_motion.h"
#include "palpate/haptics/packed_field.h"

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

/// How a slipping contact moves (thesis 5.4.2, Figure 5.6).
enum class ContactMotion {
  bracketed,         ///< to a root of |f_T| - mu f_N (Eq 5.17), found by a bracketed search
  brent,             ///< to a minimum of h(t) (Eq 5.18), found by Brent's method: `slip_contact`
  friction_boundary  ///< by the tool's way beyond the friction boundary: `slip_by_boundary`
};

struct PlaybackOptions {
  ContactMotion motion = ContactMotion::bracketed;
  /// [N] > 0. A contact holds while |f_T| - mu f_N is at most this, and a slip ends there.
  double tolerance = 2e-4;
  /// [N mm] >= 0, only with `bracketed`: limits the work that the object does on the user from
  /// touch to release. A slip that would take more ends early, beyond the friction cone. Where the
  /// contact must go to a place that stores more, as in a sharp groove, the object has only the
  /// share of its force and energy that the user has put in. Eq 5.17 alone returns up to 12 N mm on
  /// a fitted sheet where mu <= 0.2, and nothing from 0.5 on; infinity keeps to it. A later touch
  /// has what is left of the credit, and a tenth of it at least. See docs/trade-playback.md.
  double energy_credit = 0.04;
  /// >= 0. Coefficient of contacts whose friction is unknown (`has_unknown_friction`). Such objects
  /// were mostly only pressed; their stiffness across the pressing is an assumption as well.
  /// Frictionless, nothing of it is felt: the force is the one that was measured.
  double unknown_friction = 0;
  /// [N] > 0. In one tick the force changes by at most this, and by the largest stiffness of a
  /// contact times the tool's movement. Only jumps are longer: at the border, at a start inside.
  double largest_jump = 0.1;
  /// [mm] >= 0. A tool that is this far inside when the loop starts touches the nearest point of
  /// the surface; deeper ones start free.
  double start_depth = 20;
  /// [mm] > 0. A longer movement in one tick is taken for a fault of the device.
  double longest_step = 50;
  /// >= 0. So many faulty ticks keep the contact while the force decays to zero; after them the
  /// contact is forgotten, and the loop starts again with the next position.
  int hold_ticks = 20;
};

/// The state of the haptic loop between two ticks, of one `Playback`; another one starts afresh.
struct LoopState {
  ContactState contact_state = ContactState::free;
  bool has_proxy = false;  ///< false before the first tick
  /// The contact while touching; while free, its position is that of the tool at the last tick.
  TouchPoint proxy;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();   ///< [mm] the last usable position
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] the last command
  int faulty_ticks = 0;                             ///< in a row until now
  double work = 0;                                  ///< [N mm] by the user, with the credit
  SlipMemory slip;                                  ///< of the last slip of this touch
  std::uint64_t playback = 0;                       ///< whose state this is
  DelayedDisplacements delayed;                     ///< of the contact; with a rate only
  bool has_place = false;                           ///< whether `place` is that of the contact
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
  /// Where the model depends on the rate (rate_law.h), a tick is a motion with the delayed
  /// displacements held, and then a rest of `seconds` in which they follow: both are passive. They
  /// move along with the contact. Where the object would pull the tool, because the tool returns
  /// faster than it, they follow at once as far as needed, which only loses energy.
  /// \param seconds since the last tick, or 1 kHz's; counts only where the model depends on the rate
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

/// Plays a whole trajectory, beginning with a new state. Ticks last as its times tell.
[[nodiscard]] std::vector<TracePoint> play(const Playback& playback,
                                           std::span<const TrajectoryPoint> trajectory);

}  // namespace palpate::haptics
