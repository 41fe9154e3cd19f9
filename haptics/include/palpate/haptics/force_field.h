// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// A weighted multiquadric phi(x) = sqrt(|P (x - center)|^2 + epsilon^2) of a displacement x: Eq
/// 5.3 with `epsilon` instead of 1 mm under the root. If `ridge` is zero, it is isotropic with P =
/// I. Otherwise it is a ridge, which varies only along the unit vector `ridge`: P = ridge ridge^T.
struct Multiquadric {
  double weight = 0;                                 ///< [N]
  double epsilon = 1;                                ///< [mm] > 0; rounds the tip
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [mm] in the frame of the displacement
  Eigen::Vector3d ridge = Eigen::Vector3d::Zero();   ///< unit vector, or zero if isotropic

  friend bool operator==(const Multiquadric&, const Multiquadric&) = default;
};

[[nodiscard]] inline bool is_ridge(const Multiquadric& base) noexcept {
  return base.ridge != Eigen::Vector3d::Zero();
}

/// Force as a function of displacement at one contact: the gradient of a sum of multiquadrics
/// (thesis 5.3.1.2).
///
/// The elastic energy is p(x) = sum_k w_k (phi_k(x) - phi_k(0) - grad phi_k(0).x). Its gradient (Eq
/// 5.8 for isotropic bases) is the force of the tool ON THE OBJECT; the user feels the opposite.
/// Energy and force are exactly zero at zero displacement. If no weight is negative, the energy is
/// convex and nowhere below zero. Beyond the data the force stays bounded by 2 sum |w_k|.
struct ForceField {
  std::vector<Multiquadric> bases;

  friend bool operator==(const ForceField&, const ForceField&) = default;
};

/// Tolerance of a ridge's length about 1, for seven printed digits. A ridge within it has a
/// slightly different weight and epsilon, and is still convex.
inline constexpr double kRidgeTolerance = 2e-7;

/// Checks that all numbers are finite, each epsilon is > 0, and each ridge is a unit vector or
/// zero.
/// \throws InvalidInput naming `what` and the base otherwise.
void check_force_field(const ForceField& field, const char* what);

/// Rotates the displacements and forces of a field.
[[nodiscard]] ForceField rotated(ForceField field, const Eigen::Matrix3d& rotation);

/// [N mm] Elastic energy at a displacement. Real-time safe.
[[nodiscard]] double potential(const ForceField& field,
                               const Eigen::Vector3d& displacement) noexcept;

/// [N] Force of the tool on the object at a displacement (Eq 5.8). Real-time safe.
[[nodiscard]] Eigen::Vector3d force(const ForceField& field,
                                    const Eigen::Vector3d& displacement) noexcept;

/// [N/mm] Symmetric derivative of the force by the displacement; at zero displacement it is Eq 5.9
/// for isotropic bases. Real-time safe.
[[nodiscard]] Eigen::Matrix3d stiffness(const ForceField& field,
                                        const Eigen::Vector3d& displacement) noexcept;

}  // namespace palpate::haptics
