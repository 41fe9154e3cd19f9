// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// Parts of the expected squared error of a force [N^2], by the formula of
/// `BlendedField::deviation`.
struct ForceVariance {
  double contacts = 0;  ///< from the contacts themselves
  double contrast = 0;  ///< from how much their compliances differ from that of the place
  double distance = 0;  ///< from the distance to them, for `between` = 1
  double between = 0;   ///< square of the contacts' `between`, blended
  double reach = 0;     ///< [mm^2] squared distance from which `distance` follows
};

/// \param place [mm] on the surface, \param at its blend. Contacts without uncertainty count as
/// exact. Real-time safe.
[[nodiscard]] ForceVariance force_variance(std::span<const ContactModel> contacts, const Blend& at,
                                           const Eigen::Vector3d& place,
                                           const Eigen::Vector3d& displacement) noexcept;

}  // namespace palpate::haptics
