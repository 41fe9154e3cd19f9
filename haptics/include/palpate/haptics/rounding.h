// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Significant decimal digits of the weights, shape parameters and centres of a stored field. An
/// error of 5e-8 of a weight or of a length is some 1e-6 N in fields of tens of newtons, four
/// orders below what an arm can tell.
inline constexpr int kFieldDigits = 7;

/// The nearest number of so many significant decimal digits, which a file tells in as many; >= 1.
/// What is not finite, and zero, stays as it is. Nothing changes its sign, and nothing becomes
/// zero.
[[nodiscard]] double round_to_digits(double value, int digits);

/// The nearest number of so many decimal places; never -0.
[[nodiscard]] double round_to_places(double value, int places);

/// The same field in short numbers, as it is stored: each base with `kFieldDigits` digits, the
/// entries of a ridge with as many decimal places, its centre where the plane through it, across
/// the ridge, meets the axis that is nearest to the ridge. Rounding again changes nothing. Weights
/// keep their signs: what was convex is.
///
/// Everything that is said of a stored field (errors, certificates) has to be found after this.
[[nodiscard]] ForceField rounded(ForceField field);

/// The same contact in short numbers: its field, its axes to 10 decimal places, which keeps
/// `kFrameTolerance`, its friction coefficient to 6 digits and other figures to 4. Its position,
/// which lies on the surface as exactly as that is known, keeps all digits.
[[nodiscard]] ContactModel rounded(ContactModel contact);

}  // namespace palpate::haptics
