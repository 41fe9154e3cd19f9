// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "files/polygon_mesh.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh with V vertices, as glTF has it.
struct GlbMesh {
  const TriangleMesh& mesh;                 ///< [mm]
  std::optional<Eigen::Matrix3Xd> normals;  ///< 3 x V, of any length
  std::optional<Eigen::Matrix4Xd> colors;   ///< 4 x V, in [0, 1]
};

/// Functions of the module `assimp`, which needs assimp's readers of many formats.
struct AssimpFiles {
  /// Reads the content of a file, in its unit, with a vertex for each corner if the format repeats
  /// them. Parameters and errors: `read_assimp_scene`.
  PolygonMesh (*read)(const std::filesystem::path& path, std::string_view content,
                      const std::string& ending);
  /// Errors: `write_glb`.
  void (*write_glb)(std::ostream& stream, const GlbMesh& mesh, const char* what);
};

}  // namespace palpate::geometry

extern "C" const palpate::geometry::AssimpFiles palpate_assimp;
