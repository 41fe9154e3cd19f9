// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::apps {

/// Processing steps of `mesh`.
struct MeshSteps {
  std::filesystem::path rig;       ///< for range maps; if empty, rig.yaml beside them
  std::optional<double> scale;     ///< [mm] length of one unit of a depth image
  std::vector<double> intrinsics;  ///< fx, fy, cx, cy [px] of its camera
  geometry::ReadOptions meshes;    ///< for mesh files
  bool smooth_depths = false;
  bool repair = false;
  std::optional<double> fill_holes;  ///< [mm] greatest width of a hole to fill
  int smooth = 0;                    ///< iterations
  std::optional<double> tolerance;   ///< [mm] of decimation
};

/// A mesh, and a description of the steps in numbers and in words.
struct MadeMesh {
  geometry::TriangleMesh mesh;
  nlohmann::ordered_json figures;
  std::string prose;
};

/// Makes the mesh of a range map, a depth image or a mesh file.
/// \throws FileError, InvalidInput, SolverError or Unavailable, as the steps do.
[[nodiscard]] MadeMesh make_mesh(const std::filesystem::path& input, const MeshSteps& steps);

}  // namespace palpate::apps
