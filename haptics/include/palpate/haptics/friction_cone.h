// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/haptics/friction_limit.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/cone_posterior.h"

namespace palpate::haptics {

/// A force that an arm applied at a contact, and whether the tool slipped.
struct FrictionTrial {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] total force of the tool on the object
  bool slipped = false;
};

struct FrictionOptions {
  /// [N] standard deviation of each component of an applied force about the commanded one; > 0
  double force_noise = 0.01;
  /// [N] standard deviation of an error of the tangential force along the drag that is the same in
  /// all trials of a contact: friction of joints, an offset of the sensor, slips that are noticed
  /// late because the tip is round. It widens the standard error and lowers the bound; >= 0
  double steady_error = 0;
  /// Prior knowledge of the cone, used if directions were not searched. Its force noise is not
  /// used.
  probing::ConePrior prior = {};
  /// The coefficient and its bound are those at `load.force`. The fit bends the forces of the
  /// trials so that the boundary becomes a cone: f_N becomes f_N (f_N / force)^exponent.
  FrictionLoad load = {};
};

/// How well the trials determine the friction cone.
enum class FrictionStop {
  converged,
  too_few_directions,  ///< or all on one side; use only the lower bound
  too_few_levels,      ///< of the normal force: the cone is the best estimate, but unconfirmed
  never_slipped,       ///< only the lower bound is known
  frictionless,        ///< tangential forces that held are noise; the coefficient is below 0.1
  not_converged        ///< use only the lower bound
};

/// Name of a value: "converged", "too_few_directions", ...
[[nodiscard]] const char* to_string(FrictionStop stop);

/// The circular cone of forces at which a contact does not slip (thesis 5.4.1).
struct FrictionFit {
  double coefficient = 0;        ///< tangent of the angle between the cone's axis and its surface
  double coefficient_error = 0;  ///< standard error
  double lower_bound = 0;        ///< of the coefficient, with 95 % confidence
  /// Unit vector of the pressing direction, into the object. If it is not determined, that of the
  /// contact's geometric normal.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double axis_error = 0;  ///< [rad] standard error: root mean square of the angle to the true axis
  double noise = 0;       ///< [N] of the signed distances from the boundary; >= the option
  int vectors = 0;        ///< pairs of direction and force level with trials that held and slipped
  int directions = 0;     ///< number of their directions in the tangent plane
  int levels = 0;         ///< number of their levels of normal force
  bool uses_prior = false;  ///< directions were not searched: FrictionOptions::prior took part
  FrictionStop stop = FrictionStop::not_converged;  ///< check this before you use the cone
};

/// The trials at one contact: all its samples, held or slipped.
[[nodiscard]] std::vector<FrictionTrial> friction_trials(const probing::Contact& contact,
                                                         std::span<const probing::Sample> samples);

/// Fits a friction cone to trials in any order.
///
/// The signed distance of a force f from the cone is d = cos(angle) |f_T| - sin(angle) f.axis (Eq
/// 5.14). A bisection (thesis 4.3) does not measure a force with d = 0, but ends between one that
/// held, d < 0, and one that slipped, d > 0, apart from the noise of the applied forces. The cone
/// therefore maximises the likelihood of all trials, where a trial at d slips with the probability
/// e + (1 - 2 e) Phi(d / noise) with the normal distribution Phi. The probability e (5 %) of a
/// wrong slip detection bounds the weight of a single trial. This uses both ends of each interval
/// without pairing them; instead of Eq 5.15 the axis is varied in a tangent plane. The noise is
/// also estimated, but not below the option or the resolution given by the widths of the intervals.
/// The lower bound comes from the profile likelihood over axes; if nothing slipped, it is the
/// narrowest cone with which all trials would have held with a probability of 5 %.
///
/// If the arm searched no direction, but tried at most two forces in most of them, as a campaign
/// with pooled friction does (probing/campaign.h), the likelihood has no peak. The cone is then the
/// mean of `probing::ConePosterior`, its errors and the lower bound are those of that distribution,
/// and it is determined if its coefficient is known to a tenth.
/// \param normal outward geometric normal of the surface, along which the arm pressed.
/// \throws InvalidInput if a force is not finite (naming its index), the normal has zero length, or
/// the option is not > 0.
[[nodiscard]] FrictionFit fit_friction(std::span<const FrictionTrial> trials,
                                       const Eigen::Vector3d& normal,
                                       const FrictionOptions& options = {});

/// A trial contradicts a cone if it held outside or slipped inside, further from the boundary than
/// this share of its force: bisections end nearer to it.
inline constexpr double kContradictingDistance = 0.1;

/// Number of trials that contradict a cone; empty if the cone is not determined.
[[nodiscard]] std::optional<int> contradicting_trials(const FrictionFit& cone,
                                                      std::span<const FrictionTrial> trials,
                                                      const FrictionLoad& load = {});

}  // namespace palpate::haptics
