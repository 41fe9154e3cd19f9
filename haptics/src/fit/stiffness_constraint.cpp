// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/stiffness_constraint.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace palpate::haptics {
namespace {

constexpr auto kSize = static_cast<Eigen::Index>(kEntries);
// Where a factor starts, in units of force / extent: away from the kink of the factor at zero.
constexpr double kStartFloor = 1e-2;
// Eigenvalues are taken to be at least this far apart, in the same units: the curvature of the
// smallest one is infinite where two meet.
constexpr double kGap = 1e-3;

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

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> decompose(
    const Eigen::Ref<const Eigen::VectorXd>& y) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(lower_triangle(y.head(kSize)));
}

// The entries of d(v^T K w)/dK for symmetric K.
Eigen::VectorXd product_entries(const Eigen::Vector3d& v, const Eigen::Vector3d& w) {
  Eigen::VectorXd result(kSize);
  for (std::size_t e = 0; e < kEntries; ++e) {
    const int row = kEntryRow[e], column = kEntryColumn[e];
    result[static_cast<Eigen::Index>(e)] =
        row == column ? v[row] * w[row] : v[row] * w[column] + v[column] * w[row];
  }
  return result;
}

// K = [a b d; b c e; d e f].
Eigen::VectorXd minors(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const double a = y[0], b = y[1], c = y[2], d = y[3], e = y[4], f = y[5];
  Eigen::VectorXd result(7);
  result << a, c, f, a * c - b * b, a * f - d * d, c * f - e * e,
      a * c * f + 2 * b * d * e - a * e * e - b * b * f - c * d * d;
  return result;
}

Eigen::MatrixXd minors_jacobian(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const double a = y[0], b = y[1], c = y[2], d = y[3], e = y[4], f = y[5];
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(7, kSize);
  result(0, 0) = result(1, 2) = result(2, 5) = 1;
  result.row(3) << c, -2 * b, a, 0, 0, 0;
  result.row(4) << f, 0, 0, -2 * d, 0, a;
  result.row(5) << 0, 0, f, 0, -2 * e, c;
  result.row(6) << c * f - e * e, 2 * (d * e - b * f), a * f - d * d, 2 * (b * e - c * d),
      2 * (b * d - a * e), a * c - b * b;
  return result;
}

Eigen::MatrixXd minors_hessian(const Eigen::Ref<const Eigen::VectorXd>& y,
                               const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  const double a = y[0], b = y[1], c = y[2], d = y[3], e = y[4], f = y[5];
  const double m3 = multipliers[3], m4 = multipliers[4], m5 = multipliers[5], m6 = multipliers[6];
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(kSize, kSize);
  lower.diagonal() << 0, -2 * (m3 + m6 * f), 0, -2 * (m4 + m6 * c), -2 * (m5 + m6 * a), 0;
  lower(2, 0) = m3 + m6 * f;
  lower(5, 0) = m4 + m6 * c;
  lower(5, 2) = m5 + m6 * a;
  lower(4, 0) = -2 * m6 * e;
  lower(5, 1) = -2 * m6 * b;
  lower(3, 2) = -2 * m6 * d;
  lower(3, 1) = 2 * m6 * e;
  lower(4, 1) = 2 * m6 * d;
  lower(4, 3) = 2 * m6 * b;
  return lower.selfadjointView<Eigen::Lower>();
}

Eigen::MatrixXd factor_jacobian(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Eigen::Matrix3d factor = lower_triangle(y.tail(kSize));
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(kSize, 2 * kSize);
  result.leftCols(kSize).setIdentity();
  // d(C C^T)/dC_ab, entry e: (E C^T + C E^T) with E the unit matrix of (a, b)
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
Eigen::MatrixXd factor_hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
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

// Perturbation theory of second order.
Eigen::MatrixXd eigenvalue_hessian(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen = decompose(y);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(kSize, kSize);
  for (int other = 1; other < 3; ++other) {
    const Eigen::VectorXd mixed =
        product_entries(eigen.eigenvectors().col(0), eigen.eigenvectors().col(other));
    const double gap = std::max(eigen.eigenvalues()[other] - eigen.eigenvalues()[0], kGap);
    result -= 2 / gap * mixed * mixed.transpose();
  }
  return result;
}

}  // namespace

Eigen::Index StiffnessConstraint::count() const {
  switch (form) {
    case StiffnessForm::factor:
      return kSize;
    case StiffnessForm::eigenvalue:
      return 1;
    case StiffnessForm::minors:
      break;
  }
  return 7;
}

Eigen::Index StiffnessConstraint::slacks() const {
  return form == StiffnessForm::factor ? kSize : 0;
}

bool StiffnessConstraint::is_equality() const { return form == StiffnessForm::factor; }

Eigen::VectorXd StiffnessConstraint::values(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  if (form == StiffnessForm::minors) return minors(y);
  if (form == StiffnessForm::eigenvalue) return decompose(y).eigenvalues().head<1>();
  const Eigen::Matrix3d factor = lower_triangle(y.tail(kSize));
  return y.head(kSize) - lower_entries(factor * factor.transpose());
}

Eigen::MatrixXd StiffnessConstraint::jacobian(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  if (form == StiffnessForm::minors) return minors_jacobian(y);
  if (form == StiffnessForm::factor) return factor_jacobian(y);
  const Eigen::Vector3d direction = decompose(y).eigenvectors().col(0);
  return product_entries(direction, direction).transpose();
}

Eigen::MatrixXd StiffnessConstraint::hessian(
    const Eigen::Ref<const Eigen::VectorXd>& y,
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  if (form == StiffnessForm::minors) return minors_hessian(y, multipliers);
  if (form == StiffnessForm::factor) return factor_hessian(multipliers);
  return multipliers[0] * eigenvalue_hessian(y);
}

Eigen::VectorXd StiffnessConstraint::start(const Eigen::Matrix3d& stiffness) const {
  if (form != StiffnessForm::factor) return Eigen::VectorXd(0);
  // The Cholesky factor of the nearest matrix whose eigenvalues are not too small.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stiffness);
  const Eigen::Vector3d kept = eigen.eigenvalues().cwiseMax(kStartFloor);
  const Eigen::Matrix3d near =
      eigen.eigenvectors() * kept.asDiagonal() * eigen.eigenvectors().transpose();
  return lower_entries(near.llt().matrixL());
}

}  // namespace palpate::haptics
