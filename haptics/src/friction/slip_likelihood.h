// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <span>

#include "palpate/haptics/friction_cone.h"

namespace palpate::haptics {

inline constexpr double kRightAngle = std::numbers::pi / 2;  ///< [rad]

/// A friction cone, and the noise of the trials.
struct SlipCone {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< third column: the axis
  double angle = 0;                                     ///< [rad] between axis and surface
  double noise = 1;                                     ///< [N]

  /// The cone rotated by small angles about the frame's x and y axes [rad].
  [[nodiscard]] SlipCone tilted(double x, double y) const;
};

/// Parameters of a cone that a search may change in addition to its axis.
enum class FreeParameters { axis, axis_angle, axis_angle_noise };

/// Probability that slip was detected wrongly, either way. With this rate of wrong trials the lower
/// bound holds with 96 %; without any, standard errors are a tenth larger than with a probability
/// of 2 %.
inline constexpr double kLapse = 0.05;

/// Negative log-likelihood of the trials (see fit_friction).
[[nodiscard]] double slip_cost(std::span<const FrictionTrial> trials, const SlipCone& cone);

struct SlipOptimum {
  SlipCone cone;
  double cost = 0;
  /// Expected information on (rotation about x, rotation about y, angle, logarithm of the noise).
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  bool converged = false;
};

/// Minimises the cost from `start` by damped Newton steps; the noise stays >= `least_noise`.
[[nodiscard]] SlipOptimum maximise_likelihood(std::span<const FrictionTrial> trials,
                                              const SlipCone& start, FreeParameters free,
                                              double least_noise);

}  // namespace palpate::haptics
