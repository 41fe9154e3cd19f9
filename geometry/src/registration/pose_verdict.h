// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "registration/registration_target.h"

namespace palpate::geometry {

/// A refined pose, in the local frame.
struct SettledPose {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  Pairing pairing;       ///< of the moved points
  double deviation = 0;  ///< of the distances of the inliers
  bool converged = false;
  int iterations = 0;
};

/// Standard deviation of the distances of the points on the surface, if at least `fraction` of them
/// are; at least the smallest relevant length.
[[nodiscard]] double inlier_deviation(const RegistrationTarget::Impl& target,
                                      const Eigen::VectorXd& distances, double fraction);

/// Sets everything except the pose, `starts` and `iterations`.
/// \param runner_up  median distance at the best other pose, empty if there is none; local frame.
void judge(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
           const SettledPose& pose, std::optional<double> runner_up,
           const RegistrationOptions& options, Registration& result);

}  // namespace palpate::geometry
