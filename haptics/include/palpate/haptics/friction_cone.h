// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// One force that an arm tried at a contact, and whether the tool stayed.
struct FrictionTrial {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] whole force of the tool on the object
  bool slipped = false;
};

struct FrictionOptions {
  /// [N] standard deviation of an applied force about the commanded one, each component; > 0
  double force_noise = 0.01;
};

/// How far the trials determine the friction cone.
enum class FrictionStop {
  converged,
  too_few_directions,  ///< or all to one side: only the lower bound is to be used
  too_few_levels,      ///< of the normal force: the cone is the best one, but nothing confirms it
  never_slipped,       ///< only the lower bound is known
  frictionless,        ///< what held across the surface is noise; the coefficient is below 0.1
  not_converged        ///< only the lower bound is to be used
};

/// "converged", "too_few_directions", ...
[[nodiscard]] const char* to_string(FrictionStop stop);

/// The circular cone of forces at which a contact does not slip (thesis 5.4.1).
struct FrictionFit {
  double coefficient = 0;        ///< tangent of the angle between axis and surface of the cone
  double coefficient_error = 0;  ///< standard error
  double lower_bound = 0;        ///< of the coefficient: it is as large or larger, with 95 %
  /// Unit vector, the direction of pressing: into the object. Where it is not determined, that of
  /// the contact's geometric normal.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double axis_error = 0;  ///< [rad] standard error: root mean square of the angle to the true axis
  double noise = 0;       ///< [N] of the signed distances from the boundary; >= the option
  int vectors = 0;        ///< directions at levels of force with trials that held and that slipped
  int directions = 0;     ///< that these have in the tangent plane
  int levels = 0;         ///< of normal force that these have
  FrictionStop stop = FrictionStop::not_converged;  ///< read this before you use the cone
};

/// Trials at one contact: all its samples, whether they held or slipped.
[[nodiscard]] std::vector<FrictionTrial> friction_trials(const probing::Contact& contact,
                                                         std::span<const probing::Sample> samples);

/// Fits a friction cone to trials, in any order; `normal` is the geometric normal of the surface,
/// outwards, along which the arm pressed.
///
/// The signed distance of a force f to the cone, d = cos(angle) |f_T| - sin(angle) f.axis, is Eq
/// 5.14's. A bisection (thesis 4.3) does not measure a force at which d = 0 but ends between one
/// that held, d < 0, and one that slipped, d > 0, but for the noise of the applied forces. So the
/// cone is the one of greatest likelihood of what was seen, a trial at d slipping with the
/// probability e + (1 - 2 e) Phi(d / noise), Phi being the normal distribution and e (5 %) the
/// chance that slip was told wrongly, which bounds the weight of any one trial. That uses both ends
/// of each interval and needs no pairing; in place of Eq 5.15 the axis moves in a tangent plane.
/// The noise is estimated too, but not below the option, nor below what the widths of the intervals
/// let one tell. The lower bound is that of the profile likelihood over axes; where nothing
/// slipped, that of the narrowest cone with which all would have held with a probability of 5 %.
/// \throws InvalidInput if a force is not finite, naming its index; unless the normal has a length
/// and the option is > 0.
[[nodiscard]] FrictionFit fit_friction(std::span<const FrictionTrial> trials,
                                       const Eigen::Vector3d& normal,
                                       const FrictionOptions& options = {});

}  // namespace palpate::haptics
