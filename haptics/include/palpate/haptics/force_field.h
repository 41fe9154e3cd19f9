// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::haptics {

/// The function phi(x) = sqrt(|P (x - center)|^2 + epsilon^2) of a displacement x, weighted: Eq 5.3
/// with `epsilon` in place of the 1 mm under the root. Isotropic if `ridge` is zero, with P = I;
/// else a ridge, which varies along the unit vector `ridge` alone, P = ridge ridge^T.
struct Multiquadric {
  double weight = 0;                                 ///< [N]
  double epsilon = 1;                                ///< [mm] > 0; rounds the tip
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [mm] same frame as the displacement
  Eigen::Vector3d ridge = Eigen::Vector3d::Zero();   ///< unit vector, or zero: isotropic

  friend bool operator==(const Multiquadric&, const Multiquadric&) = default;
};

[[nodiscard]] inline bool is_ridge(const Multiquadric& base) noexcept {
  return base.ridge != Eigen::Vector3d::Zero();
}

/// Force against displacement at one contact: the gradient of a sum of multiquadrics
/// (thesis 5.3.1.2).
///
/// The elastic energy is p(x) = sum_k w_k (phi_k(x) - phi_k(0) - grad phi_k(0).x). Its gradient,
/// for isotropic bases Eq 5.8, is the force of the tool ON THE OBJECT; the user feels the opposite.
/// Energy and force are exactly zero at zero displacement. If no weight is negative the energy is
/// convex and nowhere below zero. Beyond the data the force stays bounded by 2 sum |w_k|.
struct ForceField {
  std::vector<Multiquadric> bases;

  friend bool operator==(const ForceField&, const ForceField&) = default;
};

/// The length of a ridge may be off 1 by this. 2e-7: rounding of seven printed digits, by which the
/// base has another weight and epsilon than it says, and is as convex.
inline constexpr double kRidgeTolerance = 2e-7;

/// \throws InvalidInput naming `what` and the base unless numbers are finite, each epsilon > 0 and
/// each ridge a unit vector or zero.
void check_force_field(const ForceField& field, const char* what);

/// The same field with its displacements and forces turned by a rotation.
[[nodiscard]] ForceField rotated(ForceField field, const Eigen::Matrix3d& rotation);

/// [N mm] elastic energy at a displacement. Real-time safe.
[[nodiscard]] double potential(const ForceField& field,
                               const Eigen::Vector3d& displacement) noexcept;

/// [N] force of the tool on the object at a displacement (Eq 5.8). Real-time safe.
[[nodiscard]] Eigen::Vector3d force(const ForceField& field,
                                    const Eigen::Vector3d& displacement) noexcept;

/// [N/mm] derivative of the force with respect to the displacement, symmetric; at zero displacement
/// it is Eq 5.9 for isotropic bases. Real-time safe.
[[nodiscard]] Eigen::Matrix3d stiffness(const ForceField& field,
                                        const Eigen::Vector3d& displacement) noexcept;

}  // namespace palpate::haptics
