// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/decimation.h"
#include "palpate/geometry/depth_noise.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_smoothing.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/geometry/self_intersection_removal.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/geometry/texture.h"
#include "palpate/geometry/triangle_mesh.h"
#include "shared/map_camera.h"

namespace palpate::apps {

/// Processing steps of `mesh`.
struct MeshSteps {
  MapCamera camera;              ///< for range maps and depth images
  geometry::ReadOptions meshes;  ///< for mesh files
  bool smooth_depths = false;
  geometry::RangeMapSmoothingOptions depth_smoothing = {};
  /// Of the depths, for `smooth_depths`; without it, that of the files beside range maps.
  std::optional<geometry::DepthNoise> noise = {};
  bool color = false;          ///< of the vertices, from the NNNNNN_color.png beside the range map
  fs::path color_images = {};  ///< folder of pictures for the same; may be empty
  geometry::RangeMapMeshOptions meshing = {};
  bool repair = false;
  geometry::RepairOptions repairing = {};
  geometry::HoleFillingOptions filling = {};  ///< done if its diameter is given
  geometry::SmoothingOptions smoothing = {.iterations = 0};
  bool remove_intersections = false;
  geometry::SelfIntersectionRemovalOptions intersections = {};
  geometry::RemeshingOptions remeshing = {};    ///< done if its length is given
  geometry::DecimationOptions decimation = {};  ///< done if one of its targets is given
};

/// A mesh, and a description of the steps in numbers and in words.
struct MadeMesh {
  geometry::TriangleMesh mesh;
  /// Of the vertices: those of the mesh file, carried along, or the colours of --color.
  geometry::Attributes attributes;
  std::optional<geometry::CornerTexture> texture = {};  ///< of the mesh file
  geometry::Camera camera = {};                         ///< of the range map or depth image
  /// See MeshFile; of the comments those that name a texture.
  std::vector<std::string> material_files = {}, materials = {}, comments = {};
  Json figures;
  std::string prose;
};

/// The noise of a camera, from range maps or depth images of a scene that does not move.
/// \throws FileError, or InvalidInput as `geometry::depth_noise`.
[[nodiscard]] geometry::DepthNoise noise_in(const std::vector<fs::path>& still, MapCamera camera);

/// Makes the mesh of a range map, a depth image or a mesh file.
/// \throws FileError, InvalidInput, SolverError or Unavailable, as the steps do.
[[nodiscard]] MadeMesh make_mesh(const fs::path& input, const MeshSteps& steps);

/// \throws InvalidInput if colours are requested in a format, ".stl", that has none.
void check_color(const MeshSteps& steps, const std::string& extension);

/// Writes a mesh that was made from `input`.
/// \throws OutputError if it cannot be written.
void write_made(const MadeMesh& made, const fs::path& input, const fs::path& output);

/// Converts the names of files in the input, such as `MeshFile::material_files`, to those that the
/// output needs.
[[nodiscard]] std::vector<std::string> seen_from(const fs::path& output, const fs::path& input,
                                                 std::vector<std::string> names);

}  // namespace palpate::apps
