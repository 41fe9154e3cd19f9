// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

struct TransformedField {
  ForceField field;
  /// Whether `field` is the transformed one to rounding; otherwise isotropic bases were refitted.
  bool exact = true;
  double reach = 0;    ///< [mm] of the displacements, before the transform, that were refitted
  double rms = 0;      ///< [N] sqrt(mean |error|^2) of the refitted force over them; 0 if exact
  double largest = 0;  ///< [N] largest error there
};

/// The field of an object that is deformed by a linear map: with displacements mapped by A the
/// energy p becomes p'(x) = factor p(A^-1 x), and so the force f'(A x) = factor A^-T f(x). It has
/// its minimum at zero wherever p has, and is convex if p is.
///
/// A ridge stays a ridge, exactly, and where A is a rotation times a scale an isotropic base stays
/// isotropic. Otherwise the level sets of an isotropic base become ellipsoids, which no base has.
/// If no weight is negative the isotropic bases are fitted anew with isotropic bases and ridges
/// whose weights are not either: the field stays convex, and so passive, everywhere. A field with a
/// negative weight is fitted anew as a whole with `FitMode::certified`, and is passive within the
/// transformed reach, whether it was or not. Refitted bases are `rounded`.
///
/// The fit is to the transformed forces at displacements from zero to 1.1 times the distance at
/// which the force of the field, in the root mean square over directions, reaches `largest_force`,
/// or three quarters of what it tends to far out if that is less. Without a force they go to the
/// median of |center| + epsilon over the bases: centres may lie far beyond what was measured.
/// \param largest_force  [N] > 0 and finite; to which the object is expected to be pressed
/// \throws InvalidInput if the field is refused by `check_force_field`, A is not finite or does not
/// keep volumes above zero, or the factor or the force is not finite and > 0; SolverError if
/// numbers overflow.
[[nodiscard]] TransformedField transform_field(const ForceField& field, const Eigen::Matrix3d& A,
                                               double factor,
                                               std::optional<double> largest_force = std::nullopt);

}  // namespace palpate::haptics
