// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::pictures {

/// Measurements at one contact: N samples in one frame.
struct ContactSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, force of the tool on the object
  std::vector<bool> on_boundary;   ///< N, whether the tool was about to slip
};

/// The fit to these measurements, in the same frame.
struct ContactFit {
  /// Maps a displacement [mm] to the force of the tool on the object [N].
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> field;
  Eigen::Vector3d friction_axis =
      Eigen::Vector3d::Zero();  ///< points into the object; any length > 0
  /// >= 0: tangential over normal force at which the tool slips; with 0 no cone is drawn.
  double friction_coefficient = 0;
};

/// Draws the measurements of one contact and their fit as a PNG of 1200 x 820 px.
///
/// Left, in 3-D: an arrow at each displacement for the measured force (in a different colour on the
/// friction boundary), the fitted force as a line on it, the tangent plane of the undeformed
/// surface, and the friction cone (force directions that stick) with its axis at the contact.
/// Right: tangential over normal force with the cone as a line, and fitted over measured force.
/// Works without a display.
/// \throws InvalidInput naming what is empty, of another size, or not finite.
/// \throws OutputError if the picture cannot be written.
void draw_force_field(const std::filesystem::path& png, const ContactSamples& samples,
                      const ContactFit& fit, const std::string& title);

}  // namespace palpate::pictures
