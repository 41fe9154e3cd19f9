// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::haptics {

/// Ways to say that a symmetric 3 x 3 matrix K is positive semi-definite, for a solver that wants
/// smooth functions.
enum class StiffnessForm {
  factor,      ///< K = C C^T, six equalities and the six entries of a lower triangular C
  eigenvalue,  ///< the smallest eigenvalue is >= 0; not smooth where two are equal
  minors       ///< all seven principal minors are >= 0
};

/// The entries of a symmetric or lower triangular matrix in the order used here.
inline constexpr std::size_t kEntries = 6;
inline constexpr std::array<int, kEntries> kEntryRow = {0, 1, 1, 2, 2, 2};
inline constexpr std::array<int, kEntries> kEntryColumn = {0, 0, 1, 0, 1, 2};

/// Constraint functions of y = (entries of K, slacks).
struct StiffnessConstraint {
  StiffnessForm form = StiffnessForm::factor;

  [[nodiscard]] Eigen::Index count() const;   ///< of functions
  [[nodiscard]] Eigen::Index slacks() const;  ///< variables that only the form has
  [[nodiscard]] bool is_equality() const;     ///< functions are to be = 0, else >= 0

  [[nodiscard]] Eigen::VectorXd values(const Eigen::Ref<const Eigen::VectorXd>& y) const;
  /// count() x y.size()
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& y) const;
  /// Sum of the functions' Hessians times multipliers.
  [[nodiscard]] Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& y,
                                        const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  /// Slacks to start with, well inside.
  [[nodiscard]] Eigen::VectorXd start(const Eigen::Matrix3d& stiffness) const;
};

}  // namespace palpate::haptics
