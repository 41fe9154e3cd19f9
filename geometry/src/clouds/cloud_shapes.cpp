// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "base/numbers.h"
#include "clouds/shape_models.h"
#include "clouds/shape_search.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using PointsRef = Eigen::Ref<const Eigen::Matrix3Xd>;

template <std::size_t Count>
std::array<int, Count> sample_of(CountedRandom& random, int points) {
  std::array<int, Count> sample{};
  for (int& point : sample) point = random.below(points);
  return sample;
}

template <std::size_t Count>
std::array<Vector3d, Count> columns(const Eigen::Matrix3Xd& matrix,
                                    const std::array<int, Count>& indices) {
  std::array<Vector3d, Count> chosen;
  for (std::size_t i = 0; i < Count; ++i) chosen[i] = matrix.col(indices[i]);
  return chosen;
}

template <typename Model>
PointsOnShape points_on(const ShapeSearch& search, const FoundShape<Model>& shape) {
  PointsOnShape on{.inliers = {}};
  double squares = 0;
  for (const int i : shape.inliers) {
    on.inliers.push_back(search.known[static_cast<std::size_t>(i)]);
    const double distance = shape.model.distance(search.points.col(i));
    squares += distance * distance;
  }
  on.rms = std::sqrt(squares / static_cast<double>(shape.inliers.size())) / search.frame.scale;
  return on;
}

Vector3d to_world(const ShapeSearch& search, const Vector3d& local) {
  return local / search.frame.scale + search.frame.centre;
}

/// One of both directions of an axis, always the same.
Vector3d with_positive_largest(const Vector3d& direction) {
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? Vector3d(-direction) : direction;
}

}  // namespace

std::optional<CloudPlane> find_plane(const PointsRef& points, const CloudShapeOptions& options) {
  if (options.max_radius != kInfinity) {
    throw InvalidInput(
        {{"CloudShapeOptions::max_radius", true}, {" does nothing: a plane has no radius"}});
  }
  const ShapeSearch search = prepare_search(points, options, 3);
  const auto shape = search_shape<PlaneModel>(search, 3, [&](CountedRandom& random) {
    return plane_through(columns(search.points, sample_of<3>(random, search.size())));
  });
  // Any plane through points on a line has all of them.
  if (!shape || !fitted(shape->model, search.points(Eigen::all, shape->inliers)))
    return std::nullopt;
  CloudPlane plane{points_on(search, *shape)};
  plane.point = to_world(search, shape->model.point);
  plane.normal = with_positive_largest(shape->model.normal);
  return plane;
}

std::optional<CloudSphere> find_sphere(const PointsRef& points, const CloudShapeOptions& options) {
  const ShapeSearch search = prepare_search(points, options, 4);
  const auto shape = search_shape<SphereModel>(
      search, 4, [&](CountedRandom& random) -> std::optional<SphereModel> {
        const std::optional<SphereModel> sphere =
            sphere_through(columns(search.points, sample_of<4>(random, search.size())));
        return sphere && sphere->radius <= search.max_radius ? sphere : std::nullopt;
      });
  if (!shape || shape->model.radius > search.max_radius) return std::nullopt;
  CloudSphere sphere{points_on(search, *shape)};
  sphere.centre = to_world(search, shape->model.centre);
  sphere.radius = shape->model.radius / search.frame.scale;
  return sphere;
}

std::optional<CloudCylinder> find_cylinder(const PointsRef& points, const PointsRef& normals,
                                           const CloudShapeOptions& options) {
  if (normals.cols() != points.cols())
    throw InvalidInput("find_cylinder: there are " + std::to_string(normals.cols()) +
                       " normals for " + std::to_string(points.cols()) +
                       " points; cloud_normals gives one per point");
  const ShapeSearch search = prepare_search(points, options, 2);
  // Two points with normals propose, but five unknowns are fitted.
  constexpr int kFewestPoints = 5;
  if (search.size() < kFewestPoints) return std::nullopt;
  const Eigen::Matrix3Xd known_normals = normals(Eigen::all, search.known);
  const auto shape = search_shape<CylinderModel>(
      search, 2, [&](CountedRandom& random) -> std::optional<CylinderModel> {
        const std::array<int, 2> sample = sample_of<2>(random, search.size());
        const std::optional<CylinderModel> cylinder =
            cylinder_through(columns(search.points, sample), columns(known_normals, sample));
        return cylinder && cylinder->radius <= search.max_radius ? cylinder : std::nullopt;
      });
  if (!shape || !(shape->model.radius <= search.max_radius)) return std::nullopt;
  const CylinderModel& model = shape->model;
  double low = 0, high = 0;
  for (const int i : shape->inliers) {
    const double along = model.axis.dot(search.points.col(i) - model.point);
    low = std::min(low, along);
    high = std::max(high, along);
  }
  CloudCylinder cylinder{points_on(search, *shape)};
  cylinder.point = to_world(search, model.point + (low + high) / 2 * model.axis);
  cylinder.axis = with_positive_largest(model.axis);
  cylinder.radius = model.radius / search.frame.scale;
  cylinder.length = (high - low) / search.frame.scale;
  return cylinder;
}

}  // namespace palpate::geometry
