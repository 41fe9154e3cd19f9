// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "operations.h"
#include "palpate/geometry/cloud_ball.h"
#include "palpate/geometry/cloud_clusters.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/cloud_outliers.h"
#include "palpate/geometry/cloud_sampling.h"
#include "palpate/geometry/cloud_shapes.h"
#include "palpate/geometry/mesh_distance.h"

namespace palpate::extremes {
namespace {

using namespace geometry;

/// Marks the chosen points, in the order of the cloud.
Result chosen(const std::vector<int>& indices, const Input& input, double tolerance = 1e-9) {
  Eigen::VectorXd is_chosen = Eigen::VectorXd::Zero(input.cloud.cols());
  for (const int i : indices) is_chosen[i] = 1;
  return numbers("chosen", is_chosen, kNumber, &Order::cloud, tolerance);
}

/// Normals whose side does not matter, as products with themselves.
Result planes(const Eigen::Matrix3Xd& normals) {
  return unknown_allowed(
      numbers("planes", normals.colwise().squaredNorm().transpose(), kNumber, &Order::cloud));
}

Results voxels(const Input& input, const Change&) {
  const VoxelSample sample = voxel_sample(input.cloud, 4 * input.length);
  return {number("voxels", static_cast<double>(sample.points.cols()), kNumber, kRoughly)};
}

Results poisson(const Input& input, const Change&) {
  return {chosen(poisson_sample(input.cloud, 3 * input.length), input)};
}

Results statistics(const Input& input, const Change& change) {
  OutlierOptions options{.max_deviations = 1.5};
  change(fields_of(options));
  return {chosen(without_outliers(input.cloud, options), input)};
}

Results isolated(const Input& input, const Change&) {
  return {chosen(without_isolated(input.cloud, 3.5 * input.length, 4), input)};
}

Results normals_of(const Input& input, const Change& change) {
  CloudNormalOptions options;
  change(fields_of(options));
  const CloudNormals found = cloud_normals(input.cloud, options);
  return {unknown_allowed(vectors("normals", found.normals, kNumber, &Order::cloud, 1e-7)),
          planes(found.normals)};
}

Results clusters(const Input& input, const Change& change) {
  CloudClusterOptions options{.max_gap = 2 * input.length};
  change(fields_of(options));
  const CloudClusters found = cloud_clusters(input.cloud, options);
  Eigen::VectorXd sizes(static_cast<Eigen::Index>(found.sizes.size()));
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    sizes[i] = found.sizes[static_cast<std::size_t>(i)];
  return {numbers("sizes", sizes)};
}

Results distances(const Input& input, const Change&) {
  return {unknown_allowed(numbers("to the cloud", distances_to_cloud(input.places, input.cloud),
                                  kLength, &Order::places)),
          unknown_allowed(
              numbers("to the third", neighbour_distances(input.cloud, 3), kLength, &Order::cloud)),
          unknown_allowed(numbers("to the ball", distances_to_surface(input.cloud, input.ball),
                                  kLength, &Order::cloud))};
}

CloudShapeOptions shape_options_of(const Input& input, const Change& change) {
  CloudShapeOptions options{.tolerance = 1.5 * input.length,
                            .min_share = 0.1,
                            .max_radius = 60 * input.extent * input.length};
  change(fields_of(options));
  return options;
}

Results plane(const Input& input, const Change& change) {
  CloudShapeOptions options{.tolerance = 1.5 * input.length};
  change(fields_of(options));
  const auto found = find_plane(input.cloud, options);
  return {
      number("found", found ? 1 : 0),
      number("inliers", found ? static_cast<double>(found->inliers.size()) : 0, kNumber, kRoughly),
      number("rms", found ? found->rms : 0, kLength, kRoughly)};
}

Results sphere(const Input& input, const Change& change) {
  const auto found = find_sphere(input.cloud, shape_options_of(input, change));
  return {
      number("found", found ? 1 : 0),
      number("inliers", found ? static_cast<double>(found->inliers.size()) : 0, kNumber, kRoughly),
      number("radius", found ? found->radius : 0, kLength, kRoughly)};
}

Results cylinder(const Input& input, const Change& change) {
  const auto found = find_cylinder(input.cloud, cloud_normals(input.cloud).normals,
                                   shape_options_of(input, change));
  return {number("found", found ? 1 : 0), number("radius", found ? found->radius : 0, kLength, 1)};
}

Results seen_ball(const Input& input, const Change&) {
  // The cloud before a camera, at any place of the object.
  const Eigen::Vector3d away(0, 0, 400 * input.extent * input.length);
  const Eigen::Matrix3Xd points = (input.place.inverse() * input.cloud).colwise() + away;
  const Eigen::Matrix3Xd normals =
      cloud_normals(points, {.viewpoints = Eigen::Matrix3Xd::Zero(3, 1)}).normals;
  const auto found = find_ball(points, normals, 20 * input.extent * input.length);
  return {number("found", found ? 1 : 0), number("rms", found ? found->rms : 0, kLength)};
}

}  // namespace

std::vector<Operation> cloud_operations() {
  return {
      {"voxel_sample", kCloud, voxels, 0, 8},
      {"poisson_sample", kCloud, poisson, 0, 0},
      {"without_outliers", kOptions | kCloud, statistics, 0, 0},
      {"without_isolated", kCloud, isolated, 0, 0},
      {"cloud_normals", kOptions | kCloud, normals_of, 0, 64},
      {"cloud_clusters", kOptions | kCloud, clusters, 0, 0},
      {"distances of points", kCloud | kPlaces | kBall, distances, 0, 8},
      {"find_plane", kOptions | kCloud, plane, 0, 64},
      {"find_sphere", kOptions | kCloud, sphere, 0, 64},
      {"find_cylinder", kOptions | kCloud, cylinder, 0, 64},
      {"find_ball", kCloud, seen_ball, 0, 1e3},
  };
}

}  // namespace palpate::extremes
