// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Scaling of forces when lengths are multiplied by S, which is s times the identity, or scales by
/// s only along an axis. p and p' are the elastic energies before and after, f and f' the forces.
enum class ForceScaling {
  /// Same material: p'(S x) = det(S) p(x). For uniform scaling this is exact for any elastic
  /// material: strains and stresses stay, energy scales with the volume, force with the area, f'(s
  /// x) = s^2 f(x), and stiffness with the length. Along an axis, the deformed object is assumed to
  /// be the stretched image of the original. Strains along and across the axis then stay, but the
  /// shear between them does not, and p does not contain its energy. This is exact for a bar pulled
  /// along the axis, and an approximation for an object that is sheared or bent.
  material,
  /// Same forces at scaled displacements: p'(S x) = det(S)^(1/3) p(x), uniformly f'(s x) = f(x).
  /// Along an axis this holds for the geometric mean over the axes, because a force must remain the
  /// gradient of an energy.
  forces,
  /// Every contact feels as before, independently of size: f'(x) = f(x).
  feel
};

struct ScaleModelOptions {
  double factor = 0;  ///< > 0 and finite, as must be its cube; must be set
  /// Direction, of any length, along which lengths are scaled; by default they are in all
  /// directions.
  std::optional<Eigen::Vector3d> axis = std::nullopt;
  ForceScaling forces = ForceScaling::material;
};

struct ScaledModel {
  Model model;
  int refitted = 0;      ///< contacts whose field could not be scaled exactly (`transform_field`)
  double refit_rms = 0;  ///< [N] largest root mean square error of these
  double refit_largest = 0;  ///< [N] largest error of these
};

/// Makes a model of a larger, smaller, longer or shorter object (thesis 6.2.4.2).
///
/// Lengths are scaled about the centre of the surface's bounding box, which stays in place.
///
/// - Along an axis, frames are rotated by the smallest rotation that maps the pressing direction z,
///   as a normal, to S^-1 z; friction axes, as displacements, become S a. Friction coefficients,
///   triangles and weights stay. The friction cone stays circular, although that of a stretched
///   object may not.
/// - Everything except positions is `rounded`; if no field was refitted, scaling back gives
///   the same model up to rounding. Fields are refitted up to the reference force of the
///   model, if any.
/// - `rms` and `noise_floor` scale like forces in the mean over the axes, and `rms` increases
///   by the refit error; `passivity` and `fit_mode` are those of a refitted field, whose `chi2`
///   and `condition` are unknown; `samples` and `fit_stop` still refer to the fit to the
///   measurements.
/// - Compliances are recomputed.
/// - Properties of the acquisition are dropped, because samples belong to the object as
///   measured: its registration, noise, fingerprint and offsets.
/// - The response of the surface grows with the object. It is dropped with an axis: its dents are
///   round.
///
/// \throws InvalidInput if `check_model` rejects the model or an option is outside its range.
/// \throws SolverError if numbers overflow.
[[nodiscard]] ScaledModel scale_model(const Model& model, const ScaleModelOptions& options);

/// Name of a scaling: "material", "forces" or "feel".
[[nodiscard]] const char* to_string(ForceScaling forces);

}  // namespace palpate::haptics
