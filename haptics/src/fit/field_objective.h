// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// A function of the parameters of a field, with its exact derivatives.
struct FieldFunction {
  double value = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;  ///< block diagonal, 5 x 5 per base
};

/// The least-squares problem of Eq 5.6 in the parameters of a force field of isotropic bases, with
/// exact derivatives. Parameters: for each base its weight, its centre and its epsilon,
/// (w, gx, gy, gz, epsilon). No units: the caller scales.
struct FieldObjective {
  Eigen::Matrix3Xd displacements;  ///< 3 x N
  Eigen::Matrix3Xd forces;         ///< 3 x N
  double weight_penalty = 0;       ///< >= 0

  /// Mean over the samples of half the squared residual, plus weight_penalty / 2 |w|^2.
  [[nodiscard]] double value(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  [[nodiscard]] Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
};

/// Number of parameters of one base. A ridge has as many: weight, epsilon, offset and direction.
inline constexpr Eigen::Index kBaseSize = 5;

/// L . K for the stiffness K at zero displacement (Eq 5.9) and a symmetric L, as needed for a
/// constraint on K.
[[nodiscard]] FieldFunction stiffness_at_zero(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                              const Eigen::Matrix3d& factor);

/// The energy at a place.
[[nodiscard]] FieldFunction energy_at(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                      const Eigen::Vector3d& place);

[[nodiscard]] ForceField to_field(const Eigen::Ref<const Eigen::VectorXd>& parameters);
/// \pre all bases are isotropic
[[nodiscard]] Eigen::VectorXd to_parameters(const ForceField& field);

}  // namespace palpate::haptics
