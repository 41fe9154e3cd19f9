// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "registration/registration_target.h"

namespace palpate::geometry {

/// The verdict tries motions of the points by this fraction of their radius (root mean square).
inline constexpr double kTrialLength = 0.1;

/// The distance by which poses are compared: the median of all points, or of the nearest
/// 2 * `min_overlap` of them, since the others may be off the surface.
[[nodiscard]] double median_distance(const Eigen::VectorXd& distances, double min_overlap);

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
