// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace palpate::haptics {

/// Whether the matrix is orthonormal and right-handed: no entry of R^T R is further than
/// `tolerance` from the identity. NaN is not.
[[nodiscard]] bool is_rotation(const Eigen::Matrix3d& matrix, double tolerance) noexcept;

/// Rotation matrix exp(B) of a rotation vector [rad], B its skew matrix (Rodrigues, Eq 5.13, with
/// the series near zero). Real-time safe.
[[nodiscard]] Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector) noexcept;

/// Rotation vector of a rotation matrix (Eq 5.12), length in [0, pi]; accurate near 0 and near pi,
/// where either of the two opposite vectors may come. Real-time safe.
[[nodiscard]] Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) noexcept;

/// Smallest rotation that turns the direction `from` into the direction `to` (not zero, any
/// length). Opposite directions: half a turn about some axis across them.
[[nodiscard]] Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& to) noexcept;

/// Weighted mean R of rotations: sum_k weights[k] log(R^T R_k) = 0 (Karcher mean).
///
/// In place of Eq 5.11, whose logarithms at the identity depend on the choice of the world frame.
/// As many weights as rotations, >= 0 with sum 1. Neither the order of the rotations nor the frame
/// matters; rotations with weight zero do not. Unique if the rotations lie within half a turn of
/// each other. Real-time safe.
[[nodiscard]] Eigen::Matrix3d blend_rotations(std::span<const Eigen::Matrix3d> rotations,
                                              std::span<const double> weights) noexcept;

}  // namespace palpate::haptics
