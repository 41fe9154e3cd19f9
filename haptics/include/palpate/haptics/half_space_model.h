// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A large linear elastic body, isotropic and homogeneous, on which the flat round end of a tool
/// sticks: the same at every contact.
///
/// Boussinesq's punch gives the normal stiffness k_n = 2 a E / (1 - nu^2), Cerruti's solution in
/// Mindlin's form for a disk that moves sideways k_t = 4 a E / ((1 + nu) (2 - nu)), with tool
/// radius a (Johnson, Contact Mechanics, 3.4 and 7.2; the coupling of the two directions, small and
/// zero for nu = 1/2, is left out). The energy is k_n / 2 d_n^2 + k_t / 2 |d_t|^2.
///
/// k_t / k_n = 2 (1 - nu) / (2 - nu) determines nu, and k_n then a E: E only with a radius that is
/// known, and neither from forces along the normal alone.
struct HalfSpaceModel {
  double young_modulus = 0;  ///< [N/mm^2] > 0
  double poisson_ratio = 0;  ///< in (-1, 1/2]
  double tool_radius = 0;    ///< [mm] > 0
};

// Displacements are tool minus contact, forces act ON THE OBJECT; world frame. All throw
// InvalidInput on numbers out of their ranges.

/// [N mm]
[[nodiscard]] double potential(const HalfSpaceModel& model, const probing::Contact& contact,
                               const Eigen::Vector3d& displacement);
/// [N] its gradient.
[[nodiscard]] Eigen::Vector3d force(const HalfSpaceModel& model, const probing::Contact& contact,
                                    const Eigen::Vector3d& displacement);
/// [N/mm] its Hessian.
[[nodiscard]] Eigen::Matrix3d stiffness(const HalfSpaceModel& model,
                                        const probing::Contact& contact);
/// [mm] Where a force takes the tool: the inverse of `force`.
[[nodiscard]] Eigen::Vector3d displacement(const HalfSpaceModel& model,
                                           const probing::Contact& contact,
                                           const Eigen::Vector3d& force);

}  // namespace palpate::haptics
