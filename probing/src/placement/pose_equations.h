// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "palpate/probing/arm_placement.h"

namespace palpate::probing {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Vector<double, 6>;

/// Normal equations of a small motion of the arm's base: a 6-vector of lengths, the rotation about
/// `centre` times `radius`, and the shift.
struct PoseEquations {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [mm] mean of the places
  double radius = 1;                                 ///< [mm] RMS of their distances from it
  Matrix6d normal = Matrix6d::Zero();
  Vector6d slope = Vector6d::Zero();

  /// \param places 3 x N [mm], frame of the camera.
  explicit PoseEquations(const Eigen::Matrix3Xd& places);

  /// Adds error^T information error of a place.
  void add(const Eigen::Vector3d& place, const Eigen::Matrix3d& information,
           const Eigen::Vector3d& error);
  /// Derivative of the motion of a place by the unknowns.
  [[nodiscard]] Eigen::Matrix<double, 3, 6> motion_at(const Eigen::Vector3d& place) const;
  /// Makes a motion free that is fixed only by noise.
  void release(const Vector6d& motion);
  /// The motion that minimises the sum; zero along directions that nothing fixes.
  [[nodiscard]] Vector6d solution() const;
  [[nodiscard]] Eigen::Isometry3d to_motion(const Vector6d& x) const;
  /// Covariance of the motion [mm^2]. A direction that nothing fixes gets the radius as deviation.
  [[nodiscard]] Matrix6d covariance(double variance) const;
};

/// A place for a further measurement.
struct Candidate {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();        ///< [mm] frame of the camera
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< as that of the measurements
};

/// Sets centre, covariance and advice, and says whether the measurements fix all directions.
/// \param candidates along which the weakest direction moves by less than the share `least_gain` of
/// its length are not considered.
/// \return the direction that they do not fix, in words.
std::optional<std::string> state_errors(const PoseEquations& equations, double variance,
                                        const std::vector<Candidate>& candidates, double least_gain,
                                        ArmPlacement& placement);

/// Adds a doubt if a pose hardly moves anything: the positions are already the camera's.
void doubt_frame(ArmPlacement& placement);

}  // namespace palpate::probing
