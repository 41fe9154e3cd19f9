// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// What a straight press meets at each vertex of the surface of a model.
struct PressValues {
  Eigen::VectorXd force;      ///< [N] the component along the press
  Eigen::VectorXd stiffness;  ///< [N/mm] growth of that force per depth
  Eigen::VectorXd deviation;  ///< [N] standard error of the force, see `BlendedField::deviation`
};

/// Computes the forces of presses at all vertices by `BlendedField`. Each press goes from the
/// vertex along the z axis of `Blend::field_frame`, into the object; the tool does not slip and
/// stays at this depth. NaN where no contact has influence; the deviation also where it is unknown.
/// \param depth [mm]
/// \throws InvalidInput unless the depth is finite and > 0, or if `check_model` rejects the model.
[[nodiscard]] PressValues press_values(const Model& model, double depth);

/// [mm] Returns the depth at which the model compares its contacts, so that it was measured there:
/// `Interpolation::reference_depth`, or the median of the depths at which contacts resist with
/// `Interpolation::reference_force`; nullopt if it has neither.
[[nodiscard]] std::optional<double> reference_press_depth(const Model& model);

}  // namespace palpate::haptics
