// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

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
/// its minimum at zero, and is convex and passive, wherever p is.
///
/// A ridge stays a ridge, exactly, and where A is a rotation times a scale an isotropic base stays
/// isotropic. Otherwise the level sets of an isotropic base become ellipsoids, which no base has:
/// the isotropic part of the field (all of it, if it has a negative weight) is fitted anew, by
/// `fit_force_field`, to its own transformed forces at displacements within the largest
/// |center| + epsilon of its bases, which is about the extent of the samples it was fitted to.
/// \throws InvalidInput if the field is refused by `check_force_field`, A is not finite or does not
/// keep volumes above zero, or the factor is not finite and > 0; SolverError if numbers overflow.
[[nodiscard]] TransformedField transform_field(const ForceField& field, const Eigen::Matrix3d& A,
                                               double factor);

}  // namespace palpate::haptics
