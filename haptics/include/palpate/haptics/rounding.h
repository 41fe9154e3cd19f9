// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Significant decimal digits of the numbers of a stored field. An error of 5e-8 of a weight or of
/// a length is some 1e-6 N in fields of tens of newtons, four orders below what an arm can tell.
inline constexpr int kFieldDigits = 7;

/// The nearest number of so many significant decimal digits, which a file tells in as many; >= 1.
/// What is not finite, and zero, stays as it is. Nothing changes its sign, and nothing becomes
/// zero.
[[nodiscard]] double round_to_digits(double value, int digits);

/// The nearest number of so many decimal places; never -0.
[[nodiscard]] double round_to_places(double value, int places);

/// The same field in short numbers, as it is stored (docs/model-file.md): each isotropic base, and
/// each ridge in its stored form, with `kFieldDigits` digits; a ridge's centre lies along it.
/// Isotropic bases come first, else they keep their order. Rounding again changes nothing. Weights
/// keep their signs: what was convex is.
///
/// Everything that is said of a stored field (errors, certificates) has to be found after this.
[[nodiscard]] ForceField rounded(ForceField field);

/// The same contact in short numbers: its field; its frame and friction axis to 1e-7, orthonormal
/// and of unit length as before; its position to 9 digits, its friction coefficient to 6 and other
/// figures to 4. Of such a contact a file tells exactly what it is.
[[nodiscard]] ContactModel rounded(ContactModel contact);

}  // namespace palpate::haptics
