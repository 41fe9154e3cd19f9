// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace palpate::pictures {

/// Errors of the forces that an arm applied, along one axis.
struct ForceErrors {
  Eigen::VectorXd commanded;          ///< [N] N
  Eigen::VectorXd gravity_only;       ///< [N] N: applied less commanded, gravity alone compensated
  Eigen::VectorXd fully_compensated;  ///< [N] N: the same with internal forces compensated too
};

/// Draws errors against commanded forces as Figure 4.7 of the thesis: one mark for each force, in
/// one colour for each compensation. The subtitle states the standard deviations. PNG of 1200 x 700
/// px. Works without a display.
/// \throws InvalidInput naming what is empty, of another size, or not finite.
/// \throws OutputError if the picture cannot be written.
void draw_force_errors(const std::filesystem::path& png, const ForceErrors& errors,
                       const std::string& title);

}  // namespace palpate::pictures
