// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_normals.h"

#include <Eigen/Eigenvalues>
#include <string>
#include <vector>

#include "base/numbers.h"
#include "clouds/normal_sides.h"
#include "clouds/point_tree.h"
#include "palpate/core/error.h"
#include "palpate/geometry/cloud_distance.h"

namespace palpate::geometry {
namespace {

/// Neighbours are on a line if their standard deviation across it is at most this fraction of that
/// along it: far above rounding, far below the resolution of any instrument.
constexpr double kThin = 1e-6;

/// Normal of the plane of least squares; NaN for points on a line.
Eigen::Vector3d normal_of(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                          const Eigen::Vector3d& centre, const std::vector<Neighbour>& found) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Neighbour& other : found) mean += points.col(other.point) - centre;
  mean /= static_cast<double>(found.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Neighbour& other : found) {
    const Eigen::Vector3d offset = points.col(other.point) - centre - mean;
    scatter.noalias() += offset * offset.transpose();
  }
  const double largest = scatter.trace();
  if (!(largest > 0)) return Eigen::Vector3d::Constant(kNan);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter / largest);
  if (axes.eigenvalues()[1] <= kThin * kThin * axes.eigenvalues()[2])
    return Eigen::Vector3d::Constant(kNan);
  return axes.eigenvectors().col(0);
}

void check(const CloudNormalOptions& options, Eigen::Index points) {
  static_cast<void>(in_range(options));
  const MessagePart viewpoints{"CloudNormalOptions::viewpoints", true};
  const Eigen::Index count = options.viewpoints.cols();
  if (count > 1 && count != points)
    throw InvalidInput(std::vector<MessagePart>{
        viewpoints,
        {": there are " + std::to_string(count) + " for " + std::to_string(points) +
         " points; none, one, or one per point are expected"}});
  if (!options.viewpoints.allFinite())
    throw InvalidInput(std::vector<MessagePart>{viewpoints, {": not all are finite"}});
}

}  // namespace

void visit(CloudNormalOptions& options, FieldVisitor& visitor) {
  visitor.begin("CloudNormalOptions");
  visitor.whole({"neighbours",
                 "Number of points, itself among them, whose plane gives the normal of a point; 16 "
                 "are usual",
                 "", false, "normals"},
                options.neighbours, at_least(3).at_most(kMostNeighbours));
}

CloudNormals cloud_normals(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                           const CloudNormalOptions& options) {
  check(options, points.cols());
  const PointTree tree(points);
  CloudNormals result{.normals = Eigen::Matrix3Xd::Constant(3, points.cols(), kNan)};
  const Eigen::Index views = options.viewpoints.cols();
  // The neighbours of each point are searched once more to turn the normals to one side.
  const auto count = static_cast<int>(tree.places().size());
  WorkSteps steps(options.progress, (views > 0 ? count : 2 * count) + 1);
  for_each_neighbourhood(tree, options.neighbours, steps,
                         [&](const PointTree::Place& place, const std::vector<Neighbour>& found) {
                           Eigen::Vector3d normal = normal_of(points, place.position, found);
                           if (views > 0) {
                             const Eigen::Vector3d from =
                                 options.viewpoints.col(views > 1 ? place.point : 0);
                             if (normal.dot(from - place.position) < 0) normal *= -1;
                           }
                           result.normals.col(place.point) = normal;
                         });
  if (views == 0) turn_to_one_side(tree, points, options.neighbours, result.normals, steps);
  result.unknown = static_cast<int>((!result.normals.row(0).array().isFinite()).count());
  steps.end();
  return result;
}

}  // namespace palpate::geometry
