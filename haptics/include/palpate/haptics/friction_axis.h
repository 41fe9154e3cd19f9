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

/// How far the pairs determine the friction axis.
enum class FrictionAxisStop {
  converged,
  too_few_pairs,       ///< that stand out of the noise
  too_few_directions,  ///< the forces across the cone's axis span no plane
  uncertain            ///< the standard error is too large for the axis to be used
};

/// "converged", "too_few_pairs", ...
[[nodiscard]] const char* to_string(FrictionAxisStop stop);

/// The friction axis N_f of one contact (thesis 5.4.2). `axis` and `error` are there iff `stop` is
/// `converged` or `uncertain`.
struct FrictionAxisFit {
  std::optional<Eigen::Vector3d> axis = std::nullopt;  ///< unit vector, into the object
  /// [rad] standard error of the axis: root mean square of the angle to the true one. Everything
  /// that the linear law does not explain counts as noise. Where that is not noise, directions that
  /// are spread evenly do better than this says.
  std::optional<double> error = std::nullopt;
  int pairs = 0;                                            ///< number of pairs used
  FrictionAxisStop stop = FrictionAxisStop::too_few_pairs;  ///< read this before you use the axis
};

/// Fits the axis about which the friction boundary lies in the space of displacements, along which
/// a slipping contact follows the tool: where the force has no part across the axis of the friction
/// cone. `cone_axis` is that axis, into the object, any length; index _N is the part along it, _T
/// the two parts across it.
///
/// On the boundary |f_T| / f_N is the same in all directions, but these displacements form no cone:
/// a stretched sheet yields far more along one tangent than along the other, so neither a cone
/// fitted to them nor, unless the directions are evenly spread, their mean is the axis. Instead
///   d_T / d_N = t + S f_T / f_N,
/// with the axis (t, 1) and a 2 x 2 matrix S, is fitted to the pairs that are settled and those on
/// the boundary, with Huber's loss. Settled pairs, nearly without f_T, hold t where directions are
/// missing. Ratios, and not displacements, let all levels of force count alike: the boundary is
/// curved, and each level has an axis of its own.
/// \throws InvalidInput if a used pair is not finite, naming its index; if sizes differ; unless the
/// cone's axis has a length and the options are in their ranges.
[[nodiscard]] FrictionAxisFit fit_friction_axis(const ForceSamples& samples,
                                                const Eigen::Vector3d& cone_axis,
                                                const FrictionAxisOptions& options = {});

}  // namespace palpate::haptics
