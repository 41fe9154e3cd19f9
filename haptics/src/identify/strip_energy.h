// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/strip_model.h"

namespace palpate::haptics {

/// The strip under one contact: parameters of the energy U of strip_model.h, in the contact's
/// frame.
struct Strip {
  Eigen::Matrix3d frame;   ///< rows X, Y, Z in the world frame
  double length_low = 0;   ///< [mm] L_1
  double length_high = 0;  ///< [mm] L_2
  double tension = 0;      ///< [N] with the width's factor w
  double axial = 0;        ///< [N] with the width's factor w
  double lateral = 0;      ///< [N/mm]
};

/// The strip under a contact. It is valid if both lengths and the width factor are > 0
/// (`is_sound`); this function does not check.
[[nodiscard]] Strip strip_at(const StripModel& model, const probing::Contact& contact);
[[nodiscard]] bool is_sound(const Strip& strip);

/// U, its gradient [N] and its Hessian [N/mm] at e [mm], local frame.
[[nodiscard]] double energy(const Strip& strip, const Eigen::Vector3d& e);
[[nodiscard]] Eigen::Vector3d gradient(const Strip& strip, const Eigen::Vector3d& e);
[[nodiscard]] Eigen::Matrix3d hessian(const Strip& strip, const Eigen::Vector3d& e);

/// The e [mm] at which the gradient is `force` [N], local frame, searched from `near` and, if that
/// fails, from zero; empty if there is none.
[[nodiscard]] std::optional<Eigen::Vector3d> find_equilibrium(
    const Strip& strip, const Eigen::Vector3d& force,
    const Eigen::Vector3d& near = Eigen::Vector3d::Zero());

}  // namespace palpate::haptics
