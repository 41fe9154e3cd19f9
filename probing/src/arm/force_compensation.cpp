// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/force_compensation.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

constexpr int kTerms = 12;
constexpr double kSmallestRange = std::numbers::pi / 6;  // [rad]
constexpr double kHunting = 10;                          // [N mm]

/// Derivatives of the potential's terms with respect to the joints.
Eigen::Matrix<double, 3, kTerms> gravity_terms(const Eigen::Vector3d& joints) {
  const double s0 = std::sin(joints[0]), c0 = std::cos(joints[0]);
  const std::array<double, 3> turn{1, s0, c0}, turn_slope{0, c0, -s0};
  Eigen::Matrix<double, 3, kTerms> terms = Eigen::Matrix<double, 3, kTerms>::Zero();
  int column = 0;
  for (std::size_t t = 0; t < turn.size(); ++t) {
    for (const int joint : {1, 2}) {
      const double s = std::sin(joints[joint]), c = std::cos(joints[joint]);
      for (const auto& [value, slope] : {std::array{s, c}, std::array{c, -s}}) {
        terms(0, column) = turn_slope[t] * value;
        terms(joint, column) = turn[t] * slope;
        ++column;
      }
    }
  }
  return terms;
}

void check_poses(std::span<const HeldPose> poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].joints.allFinite() || !poses[i].torque.allFinite()) {
      throw InvalidInput("fit_gravity: pose " + std::to_string(i) + " is not finite");
    }
    if (!(poses[i].deviation <= kHunting)) {
      throw InvalidInput("fit_gravity: pose " + std::to_string(i) + ": the torque deviates by " +
                         std::to_string(poses[i].deviation) +
                         " N mm while the joints are held; they hunt. Lower the gains");
    }
  }
  for (int joint = 0; joint < 3; ++joint) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool up = false, down = false;
    for (const HeldPose& pose : poses) {
      if (pose.direction[joint] == 0) continue;
      low = std::min(low, pose.joints[joint]);
      high = std::max(high, pose.joints[joint]);
      up = up || pose.direction[joint] > 0;
      down = down || pose.direction[joint] < 0;
    }
    const std::string name = "fit_gravity: joint " + std::to_string(joint);
    if (!(high - low >= kSmallestRange)) {
      throw InvalidInput(name + " was moved over less than 30 degrees; move it over more");
    }
    if (!up || !down) {
      throw InvalidInput(name + " was moved one way only; its friction cannot be told from " +
                         "gravity. Move it both ways");
    }
  }
}

}  // namespace

GravityModel fit_gravity(std::span<const HeldPose> poses) {
  check_poses(poses);
  const auto count = static_cast<Eigen::Index>(3 * poses.size());
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(count, kTerms + 3);
  Eigen::VectorXd torques = Eigen::VectorXd::Zero(count);
  Eigen::Index used = 0;
  for (const HeldPose& pose : poses) {
    const Eigen::Matrix<double, 3, kTerms> terms = gravity_terms(pose.joints);
    for (int joint = 0; joint < 3; ++joint) {
      if (pose.direction[joint] == 0) continue;
      design.row(used).head<kTerms>() = terms.row(joint);
      design(used, kTerms + joint) = pose.direction[joint];
      torques[used++] = pose.torque[joint];
    }
  }
  // Minimum norm: terms that the poses do not distinguish get the smallest coefficients.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  constexpr double kToldApart = 1e-3;  // relative to the largest pivot
  decomposition.setThreshold(kToldApart);
  decomposition.compute(design.topRows(used));
  const Eigen::VectorXd solution = decomposition.solve(torques.head(used));
  GravityModel model;
  model.potential = solution.head<kTerms>();
  model.friction = solution.tail<3>();
  model.residual = (design.topRows(used) * solution - torques.head(used)).norm() /
                   std::sqrt(static_cast<double>(used));
  return model;
}

Eigen::Vector3d gravity_torque(const GravityModel& model, const Eigen::Vector3d& joints) noexcept {
  return gravity_terms(joints) * model.potential;
}

Eigen::Vector3d gravity_force(const GravityModel& model, const ArmGeometry& geometry,
                              const Eigen::Vector3d& joints) noexcept {
  const Eigen::Matrix3d jacobian = arm_jacobian(geometry, joints);
  return jacobian.transpose().inverse() * gravity_torque(model, joints);
}

std::optional<Eigen::Vector3d> internal_force(std::span<const Eigen::Vector3d> held,
                                              double largest_deviation) {
  constexpr std::size_t kLeast = 100;
  if (held.size() < kLeast) {
    throw InvalidInput("internal_force: got " + std::to_string(held.size()) +
                       " forces; it needs at least " + std::to_string(kLeast));
  }
  const auto count = static_cast<double>(held.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& force : held) mean += force / count;
  for (const Eigen::Vector3d& force : held) variance += (force - mean).cwiseAbs2() / count;
  if (!(variance.maxCoeff() <= largest_deviation * largest_deviation)) return std::nullopt;
  return mean;
}

}  // namespace palpate::probing
