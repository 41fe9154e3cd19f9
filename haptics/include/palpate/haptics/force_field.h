// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::haptics {

/// Force against displacement at one contact: the gradient of a sum of multiquadrics
/// (thesis 5.3.1.2).
///
/// With d_k = x - g_k and s_k = sqrt(|d_k|^2 + epsilon^2) the elastic energy is
/// p(x) = sum_k w_k (s_k(x) - s_k(0) + g_k.x / s_k(0)). Its gradient, Eq 5.8 with `epsilon` in
/// place of the 1 mm under the root, is the force of the tool ON THE OBJECT; the user feels the
/// opposite. Energy and force are exactly zero at zero displacement. Beyond the data the force
/// stays bounded by 2 sum |w_k|.
struct ForceField {
  Eigen::Matrix3Xd centers;  ///< [mm] 3 x M, g_k, same frame as the displacement
  Eigen::VectorXd weights;   ///< [N] M, w_k
  double epsilon = 1;        ///< [mm] > 0; rounds the tip of each multiquadric
};

/// \throws InvalidInput naming `what` unless sizes agree, numbers are finite and epsilon > 0.
void check_force_field(const ForceField& field, const char* what);

/// [N mm] elastic energy at a displacement. Real-time safe.
[[nodiscard]] double potential(const ForceField& field,
                               const Eigen::Vector3d& displacement) noexcept;

/// [N] force of the tool on the object at a displacement (Eq 5.8). Real-time safe.
[[nodiscard]] Eigen::Vector3d force(const ForceField& field,
                                    const Eigen::Vector3d& displacement) noexcept;

/// [N/mm] derivative of the force with respect to the displacement, symmetric; at zero displacement
/// it is Eq 5.9. Real-time safe.
[[nodiscard]] Eigen::Matrix3d stiffness(const ForceField& field,
                                        const Eigen::Vector3d& displacement) noexcept;

}  // namespace palpate::haptics
