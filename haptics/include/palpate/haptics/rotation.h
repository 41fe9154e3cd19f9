// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// Returns true if a matrix is orthonormal and right-handed: no entry of R^T R differs by more than
/// `tolerance` from the identity. False for NaN.
[[nodiscard]] bool is_rotation(const Eigen::Matrix3d& matrix, double tolerance) noexcept;

/// Rotation matrix exp(B) of a rotation vector [rad] with the skew matrix B (Rodrigues, Eq 5.13; a
/// series near zero). Real-time safe.
[[nodiscard]] Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector) noexcept;

/// Rotation vector of a rotation matrix (Eq 5.12), with a length in [0, pi]; accurate near 0 and
/// near pi, where either of two opposite vectors may be returned. Real-time safe.
[[nodiscard]] Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) noexcept;

/// Smallest rotation that maps the direction `from` to the direction `to` (any length except 0).
/// For opposite directions, half a turn about some perpendicular axis.
[[nodiscard]] Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& to) noexcept;

/// Weighted mean R of rotations: sum_k weights[k] log(R^T R_k) = 0 (Karcher mean).
///
/// Replaces Eq 5.11, whose logarithms at the identity depend on the choice of the world frame.
/// There must be as many weights as rotations, >= 0 with sum 1. The result depends neither on the
/// order of the rotations nor on the frame, nor on rotations of zero weight. It is unique if the
/// rotations are within half a turn of each other. Real-time safe.
[[nodiscard]] Eigen::Matrix3d blend_rotations(std::span<const Eigen::Matrix3d> rotations,
                                              std::span<const double> weights) noexcept;

}  // namespace palpate::haptics
