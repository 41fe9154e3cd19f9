// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// Bulk moduli that a material may have, over its shear modulus: beyond the largest, systems are
/// too badly conditioned for the stated residuals.
inline constexpr double kLeastBulkRatio = 0.5, kMostBulkRatio = 1e4;

/// A rubber-like material, Mooney-Rivlin; neo-Hookean with `mooney_share` 0. Its energy density is
///   c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + K/4 (J^2 - 1 - 2 ln J)
/// with c10 = (1 - mooney_share) mu / 2, c01 = mooney_share mu / 2, and I1, I2 the invariants of
/// F^T F. At small strains it is linear elasticity with mu and K.
struct Hyperelastic {
  double shear_modulus = 0.02;  ///< [N/mm^2] mu; > 0
  double bulk_modulus = 0.4;    ///< [N/mm^2] K; in [mu / 2, 1e4 mu]
  double mooney_share = 0;      ///< of the second invariant in the shear stiffness; in [0, 1]
};

/// \throws InvalidInput naming the number, if one is outside its range.
void check_hyperelastic(const Hyperelastic& material);

/// [N/mm^2] Young's modulus at small strains, 9 K mu / (3 K + mu).
[[nodiscard]] double young_modulus(const Hyperelastic& material);
/// Poisson's ratio at small strains.
[[nodiscard]] double poisson_ratio(const Hyperelastic& material);

/// The isochoric part at a deformation gradient F with det F > 0.
struct IsochoricStress {
  Eigen::Matrix3d stress;               ///< [N/mm^2] first Piola-Kirchhoff, dW / dF
  Eigen::Matrix<double, 9, 9> tangent;  ///< [N/mm^2] its derivative, F in column-major order
};
[[nodiscard]] IsochoricStress isochoric_stress(const Hyperelastic& material,
                                               const Eigen::Matrix3d& gradient);
/// [N/mm^2] The energy density of the isochoric part.
[[nodiscard]] double isochoric_energy(const Hyperelastic& material,
                                      const Eigen::Matrix3d& gradient);

/// The volumetric part at a ratio of volumes J > 0.
struct VolumetricStress {
  double energy = 0;   ///< [N/mm^2]
  double stress = 0;   ///< [N/mm^2] its derivative by J
  double tangent = 0;  ///< [N/mm^2] its second derivative
};
[[nodiscard]] VolumetricStress volumetric_stress(const Hyperelastic& material, double volume_ratio);

/// The matrix of the cofactor's derivative: cross_matrix(A) vec(B) = vec(A x B), the tensor cross
/// product (A x B)_iI = e_ijk e_IJK A_jJ B_kK.
[[nodiscard]] Eigen::Matrix<double, 9, 9> tensor_cross_matrix(const Eigen::Matrix3d& a);
/// cof F = det(F) F^-T.
[[nodiscard]] Eigen::Matrix3d cofactor(const Eigen::Matrix3d& a);

}  // namespace palpate::probing
