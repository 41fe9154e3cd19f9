// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/stiffness_constraint.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace palpate::haptics::stiffness_constraint {
namespace {

constexpr auto kSize = static_cast<Eigen::Index>(kEntries);
// Least eigenvalue of the initial C C^T, in units of force / extent. At C = 0 the constraint has no
// gradient.
constexpr double kStartFloor = 1e-2;

Eigen::Matrix3d lower_triangle(const Eigen::Ref<const Eigen::VectorXd>& entries) {
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (std::size_t e = 0; e < kEntries; ++e) {
    result(kEntryRow[e], kEntryColumn[e]) = entries[static_cast<Eigen::Index>(e)];
  }
  return result;
}

Eigen::VectorXd lower_entries(const Eigen::Matrix3d& matrix) {
  Eigen::VectorXd result(kSize);
  for (std::size_t e = 0; e < kEntries; ++e) {
    result[static_cast<Eigen::Index>(e)] = matrix(kEntryRow[e], kEntryColumn[e]);
  }
  return result;
}

}  // namespace

Eigen::VectorXd values(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Eigen::Matrix3d factor = lower_triangle(y.tail(kSize));
  return y.head(kSize) - lower_entries(factor * factor.transpose());
}

Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Eigen::Matrix3d factor = lower_triangle(y.tail(kSize));
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(kSize, 2 * kSize);
  result.leftCols(kSize).setIdentity();
  // d(C C^T)/dC_ab, entry e: (E C^T + C E^T), where E has 1 at (a, b) and 0 elsewhere
  for (std::size_t e = 0; e < kEntries; ++e) {
    for (std::size_t v = 0; v < kEntries; ++v) {
      double slope = 0;
      if (kEntryRow[v] == kEntryRow[e]) slope += factor(kEntryColumn[e], kEntryColumn[v]);
      if (kEntryRow[v] == kEntryColumn[e]) slope += factor(kEntryRow[e], kEntryColumn[v]);
      result(static_cast<Eigen::Index>(e), kSize + static_cast<Eigen::Index>(v)) = -slope;
    }
  }
  return result;
}

// multiplier . (C C^T) is a quadratic form in the columns of C.
Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  const Eigen::Matrix3d halved = lower_triangle(multipliers) / 2;
  const Eigen::Matrix3d multiplier = halved + halved.transpose();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * kSize, 2 * kSize);
  for (std::size_t v = 0; v < kEntries; ++v) {
    for (std::size_t w = 0; w < kEntries; ++w) {
      if (kEntryColumn[v] != kEntryColumn[w]) continue;
      result(kSize + static_cast<Eigen::Index>(v), kSize + static_cast<Eigen::Index>(w)) =
          -2 * multiplier(kEntryRow[v], kEntryRow[w]);
    }
  }
  return result;
}

Eigen::VectorXd start(const Eigen::Matrix3d& stiffness) {
  // The Cholesky factor of the nearest matrix whose eigenvalues are at least kStartFloor.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stiffness);
  const Eigen::Vector3d kept = eigen.eigenvalues().cwiseMax(kStartFloor);
  const Eigen::Matrix3d near =
      eigen.eigenvectors() * kept.asDiagonal() * eigen.eigenvectors().transpose();
  return lower_entries(near.llt().matrixL());
}

}  // namespace palpate::haptics::stiffness_constraint
