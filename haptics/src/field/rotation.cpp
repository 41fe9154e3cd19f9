// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rotation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

// Below this angle the series 1 - x^2 / 6 of sin(x) / x and 1/2 - x^2 / 24 are exact to rounding:
// the next terms are x^4 / 120 < 1e-17.
constexpr double kSmallAngle = 1e-4;
// The mean has converged when a step rotates by less than some rounding errors.
constexpr double kMeanSettled = 1e-14;
constexpr int kMaxMeanIterations = 20;  // three are enough for frames of neighbours

}  // namespace

bool is_rotation(const Eigen::Matrix3d& matrix, double tolerance) noexcept {
  if (!matrix.allFinite()) return false;
  const Eigen::Matrix3d product = matrix.transpose() * matrix;
  return (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= tolerance &&
         matrix.determinant() > 0;
}

Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector) noexcept {
  const double angle = rotation_vector.norm();
  const bool small = angle < kSmallAngle;
  const double sine = small ? 1 - angle * angle / 6 : std::sin(angle) / angle;
  // (1 - cos x) / x^2 = 2 sin(x / 2)^2 / x^2, which does not cancel
  const double half_sine = std::sin(angle / 2);
  const double cosine =
      small ? 0.5 - angle * angle / 24 : 2 * half_sine * half_sine / (angle * angle);
  Eigen::Matrix3d skew;
  skew << 0, -rotation_vector.z(), rotation_vector.y(),  //
      rotation_vector.z(), 0, -rotation_vector.x(),      //
      -rotation_vector.y(), rotation_vector.x(), 0;
  return Eigen::Matrix3d::Identity() + sine * skew + cosine * skew * skew;
}

Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) noexcept {
  // The quaternion is accurate at every angle: its vector part is axis sin(angle / 2).
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  const double half_angle = std::atan2(sine, q.w());
  // x / sin(x) -> 1 near zero
  const double ratio = sine < kSmallAngle ? 1 + sine * sine / 6 : half_angle / sine;
  return 2 * ratio * q.vec();
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) noexcept {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(from, to);
  // Towards half a turn its length suffers from cancellation.
  return (from.dot(to) < 0 ? turn.normalized() : turn).toRotationMatrix();
}

Eigen::Matrix3d blend_rotations(std::span<const Eigen::Matrix3d> rotations,
                                std::span<const double> weights) noexcept {
  const auto heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  Eigen::Matrix3d mean = rotations[static_cast<std::size_t>(heaviest)];
  for (int i = 0; i < kMaxMeanIterations; ++i) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < rotations.size(); ++k) {
      const double weight = weights[k];
      if (weight > 0) step += weight * rotation_log(mean.transpose() * rotations[k]);
    }
    mean = mean * rotation_exp(step);
    if (!(step.norm() > kMeanSettled)) break;
  }
  return mean;
}

}  // namespace palpate::haptics
