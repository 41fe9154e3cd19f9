// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

struct DistancePicture {
  std::string title;
  std::string subtitle;
  double limit = 0;  ///< [mm] the colours span -limit to limit, > 0; beyond, they stay the ends'
  std::string scale =
      "signed distance (mm)";  ///< what the scale says: another quantity may be drawn
  bool one_sided = false;      ///< the colours span 0 to limit instead, from dark to light
};

/// Draws a surface whose triangles are coloured by a signed distance [mm], one a triangle, as a PNG
/// of 1200 x 900 px with its scale: blue is negative, white is zero, red is positive, unknown (NaN)
/// is light grey. Seen as `draw_mesh` shows a mesh, shaded only a little, so that the colours stay
/// those of the scale. Works without a display.
/// \throws InvalidInput if the mesh is not valid, the distances are not one a triangle or none of
/// them is finite, or limit <= 0; OutputError.
void draw_distances(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
                    const Eigen::Ref<const Eigen::VectorXd>& distances,
                    const DistancePicture& picture);

}  // namespace palpate::pictures
