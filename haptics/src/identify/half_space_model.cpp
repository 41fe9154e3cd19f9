// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/half_space_model.h"

#include <Eigen/Cholesky>

#include "palpate/core/require.h"

namespace palpate::haptics {

Eigen::Matrix3d stiffness(const HalfSpaceModel& model, const probing::Contact& contact) {
  const double nu = model.poisson_ratio;
  require("HalfSpaceModel::young_modulus", model.young_modulus, above(0), "N/mm^2");
  require("HalfSpaceModel::poisson_ratio", nu, above(-1).at_most(0.5));
  require("HalfSpaceModel::tool_radius", model.tool_radius, above(0), "mm");
  const double normal = 2 * model.tool_radius * model.young_modulus / (1 - nu * nu);
  const double tangential = 4 * model.tool_radius * model.young_modulus / ((1 + nu) * (2 - nu));
  const Eigen::Vector3d n = contact.normal.normalized();
  return tangential * Eigen::Matrix3d::Identity() + (normal - tangential) * n * n.transpose();
}

double potential(const HalfSpaceModel& model, const probing::Contact& contact,
                 const Eigen::Vector3d& displacement) {
  return 0.5 * displacement.dot(force(model, contact, displacement));
}

Eigen::Vector3d force(const HalfSpaceModel& model, const probing::Contact& contact,
                      const Eigen::Vector3d& displacement) {
  return stiffness(model, contact) * displacement;
}

Eigen::Vector3d displacement(const HalfSpaceModel& model, const probing::Contact& contact,
                             const Eigen::Vector3d& force) {
  return stiffness(model, contact).ldlt().solve(force);
}

}  // namespace palpate::haptics
