// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/unmeasured_directions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "fit/whitened_problem.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/pressing_estimate.h"

namespace palpate::haptics {
namespace {

// Share of all forces that may lie in an unmeasured direction for no known reason.
constexpr double kUnexplainedShare = 0.1;
// Forces along a line count if they turn from it by less than this cosine says (72 degrees).
constexpr double kLeastAlong = 0.3;
// [root mean square of the displacements] Rounding of springs: linear within what tools reach.
constexpr double kAcrossRounding = 4;

double root_mean_square(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.cols()));
}

// RMS of the forces along a direction beyond a linear function of the measured coordinates.
double unexplained(const Eigen::VectorXd& along, const Eigen::MatrixXd& coordinates) {
  const Eigen::VectorXd left = along - coordinates * coordinates.colPivHouseholderQr().solve(along);
  const double free = static_cast<double>(along.size() - coordinates.cols());
  return std::sqrt(left.squaredNorm() / std::max(free, 1.0));
}

// Mean stiffness of a field at some displacements.
Eigen::Matrix3d mean_stiffness(const ForceField& field, const Eigen::Matrix3Xd& displacements) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& x : displacements.colwise()) sum += stiffness(field, x);
  return sum / static_cast<double>(displacements.cols());
}

}  // namespace

UnmeasuredDirections unmeasured_directions(const Eigen::Matrix3Xd& displacements,
                                           const Eigen::Matrix3Xd& forces,
                                           double displacement_noise, double force_noise) {
  UnmeasuredDirections result;
  const auto count = static_cast<double>(displacements.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(displacements *
                                                             displacements.transpose() / count);
  result.axes = eigen.eigenvectors();
  result.ridge = result.axes.col(2);
  const double all = root_mean_square(forces);
  const double least =
      std::max(kRigidRatio * displacement_noise, kExact * root_mean_square(displacements));
  const double most = std::max(kRigidRatio * force_noise, kUnexplainedShare * all);
  // A line first: then both directions across are unmeasured.
  for (const int candidate : {2, 1}) {
    const Eigen::MatrixXd coordinates =
        (result.axes.rightCols(3 - candidate).transpose() * displacements).transpose();
    bool unmeasured = true;
    for (int k = 0; k < candidate; ++k) {
      const Eigen::VectorXd along = (result.axes.col(k).transpose() * forces).transpose();
      unmeasured = unmeasured && std::sqrt(std::max(eigen.eigenvalues()(k), 0.0)) <= least &&
                   unexplained(along, coordinates) <= most;
    }
    if (!unmeasured) continue;
    result.count = candidate;
    break;
  }
  if (result.count == 2) {
    const Eigen::Vector3d product = forces * (displacements.transpose() * result.axes.col(2));
    if (product.norm() > 0 &&
        std::abs(product.dot(result.axes.col(2))) >= kLeastAlong * product.norm())
      result.ridge = product.normalized();
  }
  return result;
}

MeasuredPairs measured_pairs(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                             const UnmeasuredDirections& directions) {
  const auto across = directions.axes.leftCols(directions.count);
  const Eigen::Matrix3Xd within = displacements - across * (across.transpose() * displacements);
  if (directions.count < 2) return {within, forces - across * (across.transpose() * forces)};
  const Eigen::Matrix3d along = directions.ridge * directions.ridge.transpose();
  return {along * within, along * forces};
}

ForceField with_expected_stiffness(ForceField field, const Eigen::Matrix3Xd& displacements,
                                   const UnmeasuredDirections& directions,
                                   const std::optional<Eigen::Matrix3d>& expected) {
  const auto across = directions.axes.leftCols(directions.count);
  const Eigen::Matrix3Xd within = displacements - across * (across.transpose() * displacements);
  if (directions.count == 2) {
    // Along the line an isotropic base is the same as a ridge, which adds nothing across.
    for (Multiquadric& base : field.bases) {
      if (is_ridge(base)) continue;
      const double offset = directions.ridge.dot(base.center);
      base.epsilon = std::hypot(base.epsilon, (base.center - offset * directions.ridge).norm());
      base.center = offset * directions.ridge;
      base.ridge = directions.ridge;
    }
  }
  const Eigen::Matrix3d found = mean_stiffness(field, within);
  const Eigen::Vector3d main = directions.axes.col(2);
  const Eigen::Matrix3d half_space = kHalfSpaceRatio * Eigen::Matrix3d::Identity() +
                                     (1 - kHalfSpaceRatio) * main * main.transpose();
  const Eigen::Matrix3d& prior = expected ? *expected : half_space;
  const auto measured = directions.axes.rightCols(3 - directions.count);
  const double known = (measured.transpose() * prior * measured).trace();
  if (!(known > 0)) return field;
  const double scale = (measured.transpose() * found * measured).trace() / known;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(across.transpose() * prior * across);
  const double rounding = kAcrossRounding * root_mean_square(within);
  for (int k = 0; k < directions.count; ++k) {
    const Eigen::Vector3d axis = across * eigen.eigenvectors().col(k);
    const double lacking = scale * eigen.eigenvalues()(k) - axis.dot(found * axis);
    if (!(lacking > 0)) continue;
    field.bases.push_back({.weight = lacking * rounding, .epsilon = rounding, .ridge = axis});
  }
  return field;
}

}  // namespace palpate::haptics
