// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

struct FrictionAxisOptions {
  double displacement_noise = 0.03;  ///< [mm] standard deviation of each component; >= 0
  double force_noise = 0.01;         ///< [N] standard deviation of each component; > 0
};

/// How well the pairs determine the friction axis.
enum class FrictionAxisStop {
  converged,
  too_few_pairs,       ///< that exceed the noise
  too_few_directions,  ///< the forces perpendicular to the cone's axis do not span a plane
  uncertain            ///< the standard error is too large to use the axis
};

/// Name of a value: "converged", "too_few_pairs", ...
[[nodiscard]] const char* to_string(FrictionAxisStop stop);

/// The friction axis N_f of one contact (thesis 5.4.2). `axis` and `error` have values if and only
/// if `stop` is `converged` or `uncertain`.
struct FrictionAxisFit {
  std::optional<Eigen::Vector3d> axis = std::nullopt;  ///< unit vector, into the object
  /// [rad] standard error of the axis: root mean square of the angle to the true one. Deviations
  /// from the linear law count as noise; with little noise and evenly spread directions the actual
  /// error is smaller.
  std::optional<double> error = std::nullopt;
  int pairs = 0;                                            ///< number of pairs used
  FrictionAxisStop stop = FrictionAxisStop::too_few_pairs;  ///< check this before you use the axis
};

/// Fits the friction axis: the axis of the friction boundary in the space of displacements, along
/// which a slipping contact follows the tool. On it the force has no component perpendicular to the
/// axis of the friction cone.
///
/// On the boundary |f_T| / f_N is the same in all directions, but the displacements do not form a
/// cone, because a stretched sheet yields far more along one tangent than along the other. So the
/// axis is neither that of a cone fitted to them nor, unless the directions are evenly spread,
/// their mean. Instead
///   d_T / d_N = t + S f_T / f_N
/// with the axis (t, 1) and a 2 x 2 matrix S is fitted to the settled pairs and those on the
/// boundary with Huber's loss. Index N denotes the component along the cone's axis, T the two
/// perpendicular ones. Settled pairs have almost no f_T and determine t where directions are
/// missing. Ratios instead of displacements give all levels of force the same weight, because the
/// boundary is curved and each level has its own axis.
/// \param cone_axis axis of the friction cone, into the object, any length.
/// \throws InvalidInput if a used pair is not finite (naming its index), sizes differ, the cone's
/// axis has zero length, or an option is outside its range.
[[nodiscard]] FrictionAxisFit fit_friction_axis(const ForceSamples& samples,
                                                const Eigen::Vector3d& cone_axis,
                                                const FrictionAxisOptions& options = {});

}  // namespace palpate::haptics
