// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

struct TransformedField {
  ForceField field;
  /// True if `field` is the transformed one up to rounding; false if isotropic bases were refitted.
  bool exact = true;
  double reach = 0;    ///< [mm] largest refitted displacement, before the transform
  double rms = 0;      ///< [N] sqrt(mean |error|^2) of the refitted force up to there; 0 if exact
  double largest = 0;  ///< [N] largest error of the refitted force
};

/// Transforms the field of an object that is deformed by a linear map A. The energy p becomes
/// p'(x) = factor p(A^-1 x), so the force becomes f'(A x) = factor A^-T f(x). The energy has its
/// minimum at zero if p has, and is convex if p is.
///
/// Ridges stay ridges, exactly. Isotropic bases stay isotropic if A is a rotation times a scale;
/// otherwise their level sets become ellipsoids, which no base has, and they are refitted:
/// - If no weight is negative, isotropic bases are fitted by isotropic bases and ridges without
///   negative weights, so the field stays convex and passive everywhere.
/// - A field with a negative weight is refitted as a whole with `FitMode::certified`, and becomes
///   passive within the transformed reach, even if it was not. Refitted bases are `rounded`.
///
/// The fit uses the transformed forces at displacements from zero to 1.1 times the distance at
/// which the force of the field, as the root mean square over directions, reaches `largest_force`,
/// or three quarters of its limit far out if that is less. Without `largest_force` they extend to
/// the median of |center| + epsilon over the bases; centres may lie far beyond the measurements.
/// \param largest_force  [N] > 0 and finite; the largest force expected in use
/// \throws InvalidInput if `check_force_field` rejects the field, A is not finite or its
/// determinant is not > 0, or the factor or the force is not finite and > 0.
/// \throws SolverError if numbers overflow.
[[nodiscard]] TransformedField transform_field(const ForceField& field, const Eigen::Matrix3d& A,
                                               double factor,
                                               std::optional<double> largest_force = std::nullopt);

}  // namespace palpate::haptics
