// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// Draws a shaded mesh as a PNG of 1200 x 900 px, from the camera's side: the viewer is where the
/// origin is (X right, Y down, Z away), but 25 degrees to the right and 15 above, so that relief
/// shows. Without perspective, so that the scale bar holds all over. Works without a display.
/// \throws InvalidInput if the mesh is not valid; OutputError.
void draw_mesh(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
               const std::string& title);

}  // namespace palpate::pictures
