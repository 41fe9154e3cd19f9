// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The next action of an arm. Positions and forces are in the world frame.
enum class ProbeActionKind {
  travel,   ///< in free space, to `target`
  touch,    ///< approach `target` from where the arm is until the tip touches the object
  press,    ///< apply `force` and wait until the tip rests
  drag,     ///< the same, from a pressed state to one with a tangential part
  release,  ///< the same, back to the normal part
  lift      ///< away from the object, to `target`
};

struct ProbeAction {
  ProbeActionKind kind{};
  long long trial = 0;                               ///< the number of the trial it belongs to
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< [mm]
  /// [N] of the tip on the object; before the touch, the one that is coming.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  double time_limit = 0;  ///< [s] the arm gives up after it
  /// True if the tip, once it rests, is where the sample of the trial is measured.
  bool measures_sample = false;
};

enum class ProbeOutcome {
  done,
  no_contact,  ///< nothing was touched
  fell_off,    ///< the tip lost the object, or slid further than the arm follows
  unsettled,   ///< the tip still moved at the time limit
  timed_out    ///< the arm did not arrive
};
/// "done", "no_contact", ...
[[nodiscard]] const char* to_string(ProbeOutcome outcome);

/// The load of a simulated arm on its object; measured positions and forces only approximate it.
struct TrueLoad {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< [mm] place on the undeformed surface
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    ///< [N] on the object
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();      ///< [mm]
};

struct ProbeReport {
  ProbeOutcome outcome = ProbeOutcome::done;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] of the tip as measured
  double seconds = 0;                                  ///< that the action took
  /// Of press, drag and release, if the arm measures it, otherwise NaN: the share of the
  /// displacement that came once the force was constant, without what the arm's own damping delays.
  double creep = std::numeric_limits<double>::quiet_NaN();
  /// [N mm] Of drag and release, if the arm measures it, otherwise NaN: the work on the object by
  /// the excess of the force over that before the drag, and over that after the release.
  double work = std::numeric_limits<double>::quiet_NaN();
  /// The reason why the tip does not rest, if the arm knows: a simulated object says where it has
  /// no equilibrium.
  std::string reason = {};
  /// Of a simulated arm whose tip rests on the object: for what is simulated beside it, a camera.
  std::optional<TrueLoad> truth = {};
  /// File of what a camera saw while the tip rested, relative to the store; empty: none.
  std::string range_map = {};
  std::string no_range_map = {};  ///< why the camera, if there is one, saw nothing of use
};

/// An arm, real or simulated, with its control loop below: it performs one action at a time.
class Prober {
 public:
  virtual ~Prober() = default;
  [[nodiscard]] virtual ProbeReport perform(const ProbeAction& action) = 0;
  /// Data that this arm needs, besides its description, to continue after the latest trial as if it
  /// had not been interrupted; empty if it needs none.
  [[nodiscard]] virtual std::string memory() const { return {}; }
};

}  // namespace palpate::probing
