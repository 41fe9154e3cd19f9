// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Significant decimal digits of the numbers of a stored field. A relative error of 5e-8 in a
/// weight or a length changes fields of tens of newtons by some 1e-6 N, four orders below the
/// resolution of an arm.
inline constexpr int kFieldDigits = 7;

/// Rounds to a number of significant decimal digits, >= 1, so that a file needs no more digits.
/// Non-finite values and zero are unchanged; no value changes its sign or becomes zero.
[[nodiscard]] double round_to_digits(double value, int digits);

/// Rounds to a number of decimal places; never returns -0.
[[nodiscard]] double round_to_places(double value, int places);

/// Rounds a field as it is stored (docs/model-file.md): each isotropic base, and each ridge in its
/// stored form, to `kFieldDigits` digits; a ridge's centre lies along the ridge. Isotropic bases
/// come first; otherwise the order stays. Rounding again changes nothing. Weights keep their signs,
/// so a convex field stays convex.
///
/// Errors and certificates of a stored field must be computed after rounding.
[[nodiscard]] ForceField rounded(ForceField field);

/// Rounds a contact, apart from its position: its field; its frame and friction axis to 1e-7, still
/// orthonormal and of unit length; its friction coefficient to 6 digits and other figures to 4. A
/// file stores such a contact exactly.
[[nodiscard]] ContactModel rounded(ContactModel contact);

/// Rounds a position to the ninth digit of the size of its object, however far that is from the
/// origin.
/// \param size [mm] `geometry::bounding_diagonal` of the surface; with 0, nothing is rounded
[[nodiscard]] Eigen::Vector3d rounded_position(const Eigen::Vector3d& position, double size);

/// Rounds terms of a rate to 6 digits, as they are stored.
[[nodiscard]] std::vector<RateTerm> rounded(std::vector<RateTerm> rate);

}  // namespace palpate::haptics
