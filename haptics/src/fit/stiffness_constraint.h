// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

namespace palpate::haptics {

/// The entries of a symmetric or lower triangular 3 x 3 matrix in the order used here.
inline constexpr std::size_t kEntries = 6;
inline constexpr std::array<int, kEntries> kEntryRow = {0, 1, 1, 2, 2, 2};
inline constexpr std::array<int, kEntries> kEntryColumn = {0, 0, 1, 0, 1, 2};

/// Smooth equations for a symmetric 3 x 3 matrix K to be positive semi-definite: K = C C^T with a
/// lower triangular C. The functions are the six entries of K - C C^T, which must be zero; their
/// arguments y are the entries of K, then those of C, which are additional unknowns of a solver.
namespace stiffness_constraint {

inline constexpr Eigen::Index kCount = kEntries;   ///< number of functions
inline constexpr Eigen::Index kSlacks = kEntries;  ///< number of additional unknowns

[[nodiscard]] Eigen::VectorXd values(const Eigen::Ref<const Eigen::VectorXd>& y);
/// 6 x 12
[[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& y);
/// 12 x 12, the sum of the functions' Hessians times `multipliers`; it is the same everywhere.
[[nodiscard]] Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
/// Initial entries of C, well inside the feasible set.
[[nodiscard]] Eigen::VectorXd start(const Eigen::Matrix3d& stiffness);

}  // namespace stiffness_constraint

}  // namespace palpate::haptics
