// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/half_space_model.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include "palpate/error.h"

namespace palpate::haptics {

Eigen::Matrix3d stiffness(const HalfSpaceModel& model, const probing::Contact& contact) {
  const double nu = model.poisson_ratio;
  if (!(model.young_modulus > 0 && model.tool_radius > 0 && nu > -1 && nu <= 0.5)) {
    throw InvalidInput(fmt::format(
        "half-space: Young's modulus {} N/mm^2, Poisson's ratio {} and tool radius {} mm; modulus "
        "and radius have to be > 0, the ratio in (-1, 0.5].",
        model.young_modulus, nu, model.tool_radius));
  }
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
