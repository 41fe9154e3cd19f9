// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "placement/pose_equations.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/geometry/registration.h"

namespace palpate::probing {
namespace {

/// Of the largest eigenvalue: directions below are fixed by rounding alone.
constexpr double kFixed = 1e-12;

/// A pose is determined if typical positions have standard deviations of at most this share of
/// their distance from their middle.
constexpr double kDetermined = 0.1;

/// Advice is given if it leaves at most this share of the deviation.
constexpr double kHelps = 0.95;

struct Weakest {
  Vector6d direction;
  double deviation;  ///< [mm]
};

Weakest weakest_of(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(covariance);
  return {axes.eigenvectors().col(5), std::sqrt(std::max(0.0, axes.eigenvalues()[5]))};
}

}  // namespace

PoseEquations::PoseEquations(const Eigen::Matrix3Xd& places) {
  if (places.cols() == 0) return;
  centre = places.rowwise().mean();
  radius = std::sqrt((places.colwise() - centre).colwise().squaredNorm().mean());
  if (!(radius > 0)) radius = 1;  // in one place: rotations move nothing
}

Eigen::Matrix<double, 3, 6> PoseEquations::motion_at(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d arm = (place - centre) / radius;
  Eigen::Matrix<double, 3, 6> motion;
  motion << 0, arm.z(), -arm.y(), 1, 0, 0,  //
      -arm.z(), 0, arm.x(), 0, 1, 0,        //
      arm.y(), -arm.x(), 0, 0, 0, 1;
  return motion;
}

void PoseEquations::add(const Eigen::Vector3d& place, const Eigen::Matrix3d& information,
                        const Eigen::Vector3d& error) {
  const Eigen::Matrix<double, 3, 6> motion = motion_at(place);
  normal += motion.transpose() * information * motion;
  slope += motion.transpose() * information * error;
}

void PoseEquations::release(const Vector6d& motion) {
  const Vector6d unit = motion.normalized();
  const Matrix6d rest = Matrix6d::Identity() - unit * unit.transpose();
  normal = (rest * normal * rest).eval();
  slope = (rest * slope).eval();
}

Vector6d PoseEquations::solution() const {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(normal);
  Vector6d x = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const double fixed = axes.eigenvalues()[k];
    if (!(fixed > kFixed * axes.eigenvalues()[5])) continue;
    const Vector6d direction = axes.eigenvectors().col(k);
    x -= direction.dot(slope) / fixed * direction;
  }
  return x;
}

Eigen::Isometry3d PoseEquations::to_motion(const Vector6d& x) const {
  const Eigen::Vector3d turn = x.head<3>() / radius;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0)
    motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  motion.translation() = centre + x.tail<3>() - motion.linear() * centre;
  return motion;
}

Matrix6d PoseEquations::covariance(double variance) const {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(normal);
  Matrix6d result = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const double fixed = axes.eigenvalues()[k];
    const bool free = !(fixed > kFixed * axes.eigenvalues()[5]);
    const double spread = free ? radius * radius : std::min(variance / fixed, radius * radius);
    result += spread * axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose();
  }
  return result;
}

std::optional<std::string> state_errors(const PoseEquations& equations, double variance,
                                        const std::vector<Candidate>& candidates, double least_gain,
                                        ArmPlacement& placement) {
  // Exact measurements are exact to rounding.
  const double rounding = std::numeric_limits<double>::epsilon() * equations.radius;
  variance = std::max(variance, rounding * rounding);
  const Matrix6d covariance = equations.covariance(variance);
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(1 / equations.radius), Eigen::Vector3d::Ones();
  placement.centre = equations.centre;
  placement.covariance = unit.asDiagonal() * covariance * unit.asDiagonal();

  const Weakest weakest = weakest_of(covariance);
  const std::string direction =
      geometry::describe_motion(weakest.direction.head<3>() / equations.radius,
                                weakest.direction.tail<3>(), equations.radius);
  const Matrix6d known = covariance.inverse();
  const Candidate* best = nullptr;
  double least = weakest.deviation * weakest.deviation;
  for (const Candidate& candidate : candidates) {
    const Eigen::Matrix<double, 3, 6> motion = equations.motion_at(candidate.place);
    const Eigen::Vector3d way = motion * weakest.direction;
    if (way.dot(candidate.information * way) < least_gain * least_gain * way.squaredNorm())
      continue;
    const Matrix6d more = known + motion.transpose() * candidate.information * motion / variance;
    const double left = weakest.direction.dot(more.inverse() * weakest.direction);
    if (!(left < least)) continue;
    least = left;
    best = &candidate;
  }
  if (best != nullptr && std::sqrt(least) <= kHelps * weakest.deviation) {
    placement.advice = PlacementAdvice{.tip_base = placement.T_camera_base.inverse() * best->place,
                                       .tip_camera = best->place,
                                       .direction = direction,
                                       .before = weakest.deviation,
                                       .after = std::sqrt(least)};
  }
  if (weakest.deviation <= kDetermined * equations.radius) return std::nullopt;
  return direction;
}

void doubt_frame(ArmPlacement& placement) {
  constexpr double kStill = 1;      // [mm] less than a pose is known by hand
  constexpr double kTurned = 0.01;  // [rad]
  const double moved =
      (placement.T_camera_base.inverse() * placement.centre - placement.centre).norm();
  if (moved < kStill && Eigen::AngleAxisd(placement.T_camera_base.linear()).angle() < kTurned) {
    placement.doubts.emplace_back(
        "the pose is almost the identity: the positions are already in the frame of the camera; "
        "give positions in the frame of the arm's base");
  }
}

}  // namespace palpate::probing
