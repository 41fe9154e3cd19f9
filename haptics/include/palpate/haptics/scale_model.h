// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// What becomes of forces when lengths are multiplied: by S, which is s times the identity, or
/// multiplies by s along an axis alone. p' and p are the elastic energies, f' and f the forces.
enum class ForceScaling {
  /// The object is of the same material: p'(S x) = det(S) p(x). Uniformly this is exact for any
  /// elastic material: strains and stresses stay, the energy goes with the volume, forces with the
  /// area, f'(s x) = s^2 f(x), stiffness with the length. Along an axis it takes the deformed
  /// object to be the stretched image of what it was. Strains along and across the axis stay then,
  /// but shear between the two does not, and the energy of that is not told by p: exact for a bar
  /// that is pulled along the axis, an approximation where the object is sheared or bent.
  material,
  /// Forces stay while displacements scale: p'(S x) = det(S)^(1/3) p(x), uniformly
  /// f'(s x) = f(x). (Along an axis they stay in the geometric mean over the axes: a force must
  /// remain the gradient of an energy.)
  forces,
  /// Every contact feels as before, whatever its size: f'(x) = f(x).
  feel
};

struct ScaleModelOptions {
  double factor = 0;  ///< > 0, its cube too, and finite; to be set
  /// Direction of any length along which alone lengths are multiplied; without one, all are.
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
/// Lengths are multiplied about the centre of the surface's bounding box, which stays. Along an
/// axis, frames turn by the smallest turn that takes the direction of pressing z, as a normal,
/// to S^-1 z; axes of friction, which are displacements, go to S a. Coefficients of friction,
/// triangles and weights stay; the circular cone of friction stays one, though a stretched
/// object's might not. All but places is `rounded`; scaling back gives the same model to that
/// if no field was refitted. Fields are refitted as far as the reference force of the model
/// presses, if it has one. `rms` and `noise_floor` scale as forces do in the mean over the
/// axes, `rms` grows by what refitting lost; `passivity` and `fit_mode` are those of a refitted
/// field, whose `chi2` and `condition` are not known; `samples` and `fit_stop` tell of the fit
/// to the measurements. Compliances are learnt anew. The registration of the acquisition is
/// dropped: samples belong to the object as it was measured.
/// \throws InvalidInput if the model is refused by `check_model` or an option is out of its range;
/// SolverError if numbers overflow.
[[nodiscard]] ScaledModel scale_model(const Model& model, const ScaleModelOptions& options);

/// "material", "forces" or "feel".
[[nodiscard]] const char* to_string(ForceScaling forces);

}  // namespace palpate::haptics
