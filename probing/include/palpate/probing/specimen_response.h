// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

/// A force for which a specimen has no displacement.
struct UnansweredForce {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    ///< [N] on the object
  std::string reason;                                 ///< as the specimen gives it
};

/// The displacement [mm] that a force [N] causes at a contact [mm]. If there is no equilibrium, or
/// the tip cannot come to the contact, none, and `reason` receives why.
[[nodiscard]] std::optional<Eigen::Vector3d> response_of(const Specimen& specimen,
                                                         const Eigen::Vector3d& contact,
                                                         const Eigen::Vector3d& force,
                                                         std::string& reason);
[[nodiscard]] std::optional<Eigen::Vector3d> response_of(SpecimenContact& contact,
                                                         const Eigen::Vector3d& force,
                                                         std::string& reason);

}  // namespace palpate::probing
