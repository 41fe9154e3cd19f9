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
  double limit = 0;  ///< [mm] the colours span -limit to limit, > 0; values outside are clamped
  std::string scale =
      "signed distance (mm)";  ///< label of the scale; change it to draw another quantity
  bool one_sided = false;      ///< the colours span 0 to limit instead, from dark to light
};

/// Draws a surface whose triangles are coloured by a signed distance [mm], one per triangle, as a
/// PNG of 1200 x 900 px with its scale: blue is negative, white is zero, red is positive, unknown
/// (NaN) is light grey. The view is that of `draw_mesh`, with little shading so that the colours
/// match the scale. Works without a display.
/// \throws InvalidInput if the mesh is not valid, there is not one distance per triangle or none is
/// finite, or limit <= 0.
/// \throws OutputError if the picture cannot be written.
void draw_distances(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
                    const Eigen::Ref<const Eigen::VectorXd>& distances,
                    const DistancePicture& picture);

}  // namespace palpate::pictures
