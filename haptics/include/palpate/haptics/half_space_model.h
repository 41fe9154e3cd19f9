// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A large linear elastic body, isotropic and homogeneous, with the flat round end of a tool
/// sticking to it; the same at every contact.
///
/// With the tool radius a, Boussinesq's punch gives the normal stiffness k_n = 2 a E / (1 - nu^2),
/// and Cerruti's solution in Mindlin's form for a disk that moves sideways gives the tangential
/// stiffness k_t = 4 a E / ((1 + nu) (2 - nu)) (Johnson, Contact Mechanics, 3.4 and 7.2). The
/// coupling of both directions, which is small and zero for nu = 1/2, is neglected. The energy is
/// k_n / 2 d_n^2 + k_t / 2 |d_t|^2.
///
/// k_t / k_n = 2 (1 - nu) / (2 - nu) determines nu, and k_n then a E. So E requires a known radius,
/// and normal forces alone determine neither.
struct HalfSpaceModel {
  double young_modulus = 0;  ///< [N/mm^2] > 0
  double poisson_ratio = 0;  ///< in (-1, 1/2]
  double tool_radius = 0;    ///< [mm] > 0
};

// Displacements are tool minus contact; forces act ON THE OBJECT; world frame. All functions throw
// InvalidInput if a number is outside its range.

/// [N mm] Elastic energy.
[[nodiscard]] double potential(const HalfSpaceModel& model, const probing::Contact& contact,
                               const Eigen::Vector3d& displacement);
/// [N] Gradient of the energy.
[[nodiscard]] Eigen::Vector3d force(const HalfSpaceModel& model, const probing::Contact& contact,
                                    const Eigen::Vector3d& displacement);
/// [N/mm] Hessian of the energy.
[[nodiscard]] Eigen::Matrix3d stiffness(const HalfSpaceModel& model,
                                        const probing::Contact& contact);
/// [mm] Displacement of the tool under a force: the inverse of `force`.
[[nodiscard]] Eigen::Vector3d displacement(const HalfSpaceModel& model,
                                           const probing::Contact& contact,
                                           const Eigen::Vector3d& force);

}  // namespace palpate::haptics
