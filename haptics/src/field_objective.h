// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// The least-squares problem of Eq 5.6 in the parameters of a force field, with exact derivatives.
/// Parameters: for each base its weight and its centre, (w, gx, gy, gz). No units: the caller
/// scales.
struct FieldObjective {
  Eigen::Matrix3Xd displacements;  ///< 3 x N
  Eigen::Matrix3Xd forces;         ///< 3 x N
  double epsilon = 1;
  double weight_penalty = 0;  ///< >= 0

  /// Mean over the samples of half the squared residual, plus weight_penalty / 2 |w|^2.
  [[nodiscard]] double value(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  [[nodiscard]] Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// L . K with K the stiffness at zero displacement (Eq 5.9), its gradient and its Hessian, for a
  /// symmetric L: what a constraint on K needs.
  struct Contraction {
    double value = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  ///< block diagonal, 4 x 4 a base
  };
  [[nodiscard]] Contraction stiffness_at_zero(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                              const Eigen::Matrix3d& factor) const;
};

[[nodiscard]] ForceField to_field(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                  double epsilon);
[[nodiscard]] Eigen::VectorXd to_parameters(const ForceField& field);

}  // namespace palpate::haptics
