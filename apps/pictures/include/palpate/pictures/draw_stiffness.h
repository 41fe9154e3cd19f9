// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

struct StiffnessPicture {
  Eigen::VectorXd stiffness;  ///< [N/mm] at each vertex; NaN where it is not known
  Eigen::Matrix3Xd contacts;  ///< [mm] 3 x C
  Eigen::Matrix3Xd contour;   ///< [mm] 3 x 2N, segments; empty: none is drawn
  std::string title, subtitle;
};

/// Draws a surface coloured by stiffness, from dark (soft) to light (stiff), unknown in light grey,
/// with its contacts as points and a contour as a line, in the view of `draw_mesh`. PNG of 1200 x
/// 900 px. Works without a display.
/// \throws InvalidInput if the surface is not valid, a size differs, a contact or the contour is
/// not finite, or no stiffness is.
/// \throws OutputError if the picture cannot be written.
void draw_stiffness(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                    const StiffnessPicture& picture);

}  // namespace palpate::pictures
