// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/cloud_clusters.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/cloud_outliers.h"
#include "palpate/geometry/cloud_shapes.h"
#include "palpate/geometry/mesh_io.h"
#include "shared/map_camera.h"

namespace palpate::apps {

/// Settings that steps of `cloud` need besides their own value.
struct CloudSettings {
  MapCamera camera;                          ///< for range maps and depth images
  geometry::ReadOptions points;              ///< for other files
  bool color = false;                        ///< from the NNNNNN_color.png beside each range map
  std::optional<Eigen::Vector3d> viewpoint;  ///< [mm] for normals
  geometry::OutlierOptions outliers;
  geometry::CloudNormalOptions normals;
  geometry::CloudShapeOptions shapes;
  geometry::CloudClusterOptions clusters;
};

/// A cloud between two steps, and the results of the earlier steps in numbers and in words.
struct WorkedCloud {
  geometry::PointCloud cloud;
  /// The kind of points that the last step found, for --keep and --remove; empty if none.
  std::string found_what = {};
  std::vector<int> found = {};  ///< indices of its points
  Json steps = Json::array();
  std::string prose = {};
};

/// Reads range maps, depth images, clouds and the vertices of meshes as one cloud. A single range
/// map stays organised and gets the deviations beside it; if all are range maps and no viewpoint is
/// given, it is set to their camera.
/// \throws FileError or InvalidInput.
[[nodiscard]] WorkedCloud load_cloud(const std::vector<fs::path>& inputs, CloudSettings& settings);

/// Writes an organised cloud as a range map NAME.tiff, its colours, if it has some, as
/// NAME_color.png, and its camera as the rig.yaml of the folder, unless it is there.
/// \param camera that of the cloud. Without it, that of the rig.yaml in the folder or, if there is
/// none, the one without lens distortion that fits the points.
/// \returns a description of the camera that was used or written, in words.
/// \throws InvalidInput if the cloud is not organised, no camera sees each point at its pixel, or
/// the rig.yaml in the folder is that of another camera. Nothing is written then.
/// \throws OutputError.
[[nodiscard]] std::string write_as_range_map(const fs::path& path,
                                             const geometry::PointCloud& cloud,
                                             const std::optional<geometry::Camera>& camera);

// The steps. Each throws InvalidInput if it would leave no point. An organised cloud stays so if a
// step only removes points.
void crop(WorkedCloud& worked, const Eigen::AlignedBox3d& box);
void remove_outliers(WorkedCloud& worked, const CloudSettings& settings);
void remove_isolated(WorkedCloud& worked, double radius, int neighbours);
void average_voxels(WorkedCloud& worked, double edge);
void sample_poisson(WorkedCloud& worked, double min_distance);
void find_normals(WorkedCloud& worked, const CloudSettings& settings);
void measure_from_mesh(WorkedCloud& worked, const fs::path& reference,
                       const CloudSettings& settings);
void measure_from_cloud(WorkedCloud& worked, const fs::path& reference,
                        const CloudSettings& settings);

// Steps that find something among the points, and mark it in an attribute.
/// \throws SolverError if there is no such shape.
void mark_plane(WorkedCloud& worked, const CloudSettings& settings);
void mark_sphere(WorkedCloud& worked, const CloudSettings& settings);
void mark_cylinder(WorkedCloud& worked, const CloudSettings& settings);
void mark_clusters(WorkedCloud& worked, const CloudSettings& settings);

/// Keeps or removes the points that were found last.
/// \throws InvalidInput if nothing was found since the points changed.
void keep_found(WorkedCloud& worked);
void remove_found(WorkedCloud& worked);

/// Points with finite coordinates.
[[nodiscard]] Eigen::Index known_count(const geometry::PointCloud& cloud);

/// The attributes with the number of the shape or cluster of a point.
inline constexpr const char* kShapeAttribute = "shape";
inline constexpr const char* kClusterAttribute = "cluster";

/// Notes the result of a step.
/// \param name of its option
/// \param known_before points that were known before it
void note_step(WorkedCloud& worked, const std::string& name, Eigen::Index known_before,
               const Json& figures, const std::string& words);

/// Keeps some points, as a step of this name. An organised cloud stays so.
/// \param words the common property of the kept points
/// \throws InvalidInput if there are none.
void keep_only(WorkedCloud& worked, const std::string& name, const std::vector<int>& kept,
               const std::string& words);

}  // namespace palpate::apps
