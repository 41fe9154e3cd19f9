// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/haptics/friction_cone.h"

namespace palpate::haptics {

/// A cone of forces that hold, and the noise of the trials.
struct SlipCone {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< third column: the axis
  double angle = 0;                                     ///< [rad] between axis and surface
  double noise = 1;                                     ///< [N]

  /// Turned by small angles about the frame's x and y axes [rad].
  [[nodiscard]] SlipCone tilted(double x, double y) const;
};

/// Which of a cone's parameters a search may change, besides its axis.
enum class FreeParameters { axis, axis_angle, axis_angle_noise };

/// Chance that a trial's slip was told wrongly, either way. Where that many are, the lower bound
/// holds with 96 %; where none is, the errors are a tenth larger than with a chance of 2 %.
inline constexpr double kLapse = 0.05;

/// Negative logarithm of the likelihood of the trials (see fit_friction).
[[nodiscard]] double slip_cost(std::span<const FrictionTrial> trials, const SlipCone& cone);

struct SlipOptimum {
  SlipCone cone;
  double cost = 0;
  /// Expected information on (turn about x, turn about y, angle, logarithm of the noise).
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  bool converged = false;
};

/// Least cost from `start` on, by Newton's method with damping; the noise stays >= `least_noise`.
[[nodiscard]] SlipOptimum maximise_likelihood(std::span<const FrictionTrial> trials,
                                              const SlipCone& start, FreeParameters free,
                                              double least_noise);

}  // namespace palpate::haptics
