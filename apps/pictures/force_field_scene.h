// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "canvas.h"
#include "palpate/pictures/draw_force_field.h"

namespace palpate::pictures {

inline constexpr Rgb kStickingColor = kBlue;
inline constexpr Rgb kBoundaryColor = kVermilion;
inline constexpr Rgb kFittedColor = kBlack;
inline constexpr Rgb kConeColor = kOrange;
inline constexpr Rgb kPlaneColor{170, 170, 170};

/// The samples of one contact and the fit's results for them.
struct FittedSamples {
  const ContactSamples& samples;
  Eigen::Matrix3Xd fitted;  ///< [N] 3 x N
  Eigen::Vector3d axis;     ///< of the friction cone, unit
  double friction_coefficient = 0;
};

/// Draws them in 3-D on a part of the canvas.
/// \return [mm] cell size of the grid on the tangent plane.
double add_force_field_scene(Canvas& canvas, const Box& box, const FittedSamples& contact);

}  // namespace palpate::pictures
