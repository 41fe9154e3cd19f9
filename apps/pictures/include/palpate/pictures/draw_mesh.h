// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// The part of a mesh to show.
enum class MeshPart {
  whole,
  /// In the frame of a camera: without the triangles of a background, such as a wall, that a gap in
  /// depth separates from the object. The subtitle says what was left out.
  object
};

/// Draws a shaded mesh as a PNG of 1200 x 900 px, seen from the camera's side: the viewer is at the
/// origin (X right, Y down, Z away), moved by 25 degrees to the right and 15 degrees upwards to
/// show relief. The projection is parallel, so that the scale bar is valid everywhere. Works
/// without a display.
/// \throws InvalidInput if the mesh is not valid.
/// \throws OutputError if the picture cannot be written.
void draw_mesh(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
               const std::string& title, MeshPart part = MeshPart::whole);

}  // namespace palpate::pictures
