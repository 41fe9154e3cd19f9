// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace palpate::haptics {

/// Errors of a set-up that a model cannot know: they decide where its surface and its contacts are.
/// Standard deviations [mm] >= 0; empty: not known.
struct SurfaceErrors {
  std::optional<double> depth_noise = std::nullopt;   ///< of the depth of each vertex on its own
  std::optional<double> depth_offset = std::nullopt;  ///< of the depth of the whole surface
  std::optional<double> registration = std::nullopt;  ///< RMS length of the shift of the contacts
};

/// The sources of the expected error of the force, each as a root mean square over the same random
/// presses and drags (`ErrorForecast`). The sources are independent, so their squares add up.
struct ErrorBudget {
  // [N] Parts of the error that the model states: of the force for a given displacement of a given
  // place of the surface.
  double force_noise = 0;     ///< noise of the force sensor that fits did not average out
  double position_noise = 0;  ///< the same of the positions of the tool
  /// Errors of the fits that noise does not explain. Includes the noise of the forces if the model
  /// was reduced or its measurements are not known.
  double fit = 0;
  double across = 0;    ///< forces across the pressing, if the tool only pressed
  double spacing = 0;   ///< of predicting places between contacts
  double contrast = 0;  ///< the same where the contacts around differ in stiffness

  // [N/mm] Error of the force for 1 mm of each error of the surface, which no model states.
  double per_depth_noise = 0;   ///< `SurfaceErrors::depth_noise`
  double per_depth_offset = 0;  ///< `SurfaceErrors::depth_offset`
  double per_registration = 0;  ///< `SurfaceErrors::registration`

  /// [N] The error that the model states: the root of the sum of the squares of its parts.
  [[nodiscard]] double stated() const;

  /// [N] The same with those errors of the set-up that are known.
  /// \throws InvalidInput naming one that is not >= 0 and finite.
  [[nodiscard]] double with(const SurfaceErrors& errors) const;
};

}  // namespace palpate::haptics
