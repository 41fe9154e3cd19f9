// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::pictures {

/// What was measured at one contact, N samples in one frame.
struct ContactSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, that the tool applies to the object
  std::vector<bool> on_boundary;   ///< N, measured where the tool was about to slip
};

/// What was fitted to it, in the same frame.
struct ContactFit {
  /// Displacement [mm] to the force that the tool applies to the object [N].
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> field;
  Eigen::Vector3d friction_axis =
      Eigen::Vector3d::Zero();  ///< points into the object; of any length > 0
  /// >= 0: tangential force by normal force where the tool slips; 0: no cone is drawn.
  double friction_coefficient = 0;
};

/// Draws the measurements of one contact and their fit as a PNG of 1200 x 820 px.
///
/// Left, in space: an arrow at each displacement for the measured force (friction boundary in a
/// colour of its own), the fitted force as a line on it, the undeformed surface's tangent plane,
/// and the friction cone (the directions of force that stick) with its axis at the contact. Right:
/// tangential against normal force with the cone as a line, and fitted against measured force.
/// Works without a display.
/// \throws InvalidInput naming what is empty, of another size, or not finite; OutputError.
void draw_force_field(const std::filesystem::path& png, const ContactSamples& samples,
                      const ContactFit& fit, const std::string& title);

}  // namespace palpate::pictures
