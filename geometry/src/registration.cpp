// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/registration.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls.h>
#include <pcl/registration/transformation_estimation_svd.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/surface_query.h"

// PCL estimates each step, in single precision on points in the local frame: the target centred on
// its bounding box and scaled by a power of two to about [-1, 1]. Foot points and poses are in
// double.

namespace palpate::geometry {
namespace {

using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;

/// The pose has converged iff a step changes it by at most this (rotation in rad plus translation
/// in the local frame): the rounding of PCL's points.
constexpr double kConverged = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// Steps to the foot points go before steps to their planes until one changes the pose by at most
/// this (as above): far from the surface its planes mislead.
constexpr double kNear = 0.02;

/// The planes fix the pose iff the least eigenvalue of their equations is above this fraction of
/// the largest. Otherwise the points would slide (a plate, a sphere), and steps go to the foot
/// points.
constexpr double kFixed = 1e-6;

constexpr int kMinPairs = 3;

/// Points and their foot points on the target.
struct Pairs {
  Cloud points;               ///< local frame
  Cloud feet;                 ///< local frame, with the target's normals
  double sum_of_squares = 0;  ///< [mm^2] of the distances
  bool planes_fix_pose = false;
};

class Target {
 public:
  Target(const TriangleMesh& mesh, double max_distance)
      : query_(mesh), normals_(triangle_normals(mesh)), max_distance_(max_distance) {
    const Eigen::Vector3d lower = mesh.vertices.rowwise().minCoeff();
    const Eigen::Vector3d upper = mesh.vertices.rowwise().maxCoeff();
    centre_ = (lower + upper) / 2;
    const double half_extent = (upper - lower).maxCoeff() / 2;
    scale_ = half_extent > 0 ? std::ldexp(1.0, -std::ilogb(half_extent) - 1) : 1.0;
  }

  /// Pairs of the points that have a foot point near enough on a triangle with a normal.
  [[nodiscard]] Pairs pair(const Eigen::Matrix3Xd& points) const {
    std::vector<ClosestPoint> closest(static_cast<size_t>(points.cols()));
    tbb::parallel_for(size_t{0}, closest.size(), [&](size_t i) {
      closest[i] = query_.closest_point(points.col(static_cast<Eigen::Index>(i)));
    });
    Pairs pairs;
    Eigen::Matrix<double, 6, 6> equations = Eigen::Matrix<double, 6, 6>::Zero();
    for (size_t i = 0; i < closest.size(); ++i) {
      if (!(closest[i].distance <= max_distance_)) continue;
      const Eigen::Vector3d normal = normals_.col(closest[i].at.triangle);
      if (!normal.allFinite()) continue;
      const Eigen::Vector3d foot = to_local(closest[i].position);
      pairs.points.push_back(to_point(to_local(points.col(static_cast<Eigen::Index>(i))), normal));
      pairs.feet.push_back(to_point(foot, normal));
      pairs.sum_of_squares += closest[i].distance * closest[i].distance;
      Eigen::Vector<double, 6> row;
      row << foot.cross(normal), normal;
      equations += row * row.transpose();
    }
    const Eigen::Vector<double, 6> eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(equations,
                                                                   Eigen::EigenvaluesOnly)
            .eigenvalues();
    pairs.planes_fix_pose = eigenvalues[0] > kFixed * eigenvalues[5];
    return pairs;
  }

  /// A motion of the local frame as one of the world.
  [[nodiscard]] Eigen::Isometry3d to_world(const Eigen::Isometry3d& motion) const {
    Eigen::Isometry3d world = motion;
    world.translation() = centre_ + motion.translation() / scale_ - motion.linear() * centre_;
    return world;
  }

 private:
  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& world) const {
    return (world - centre_) * scale_;
  }
  static Point to_point(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
    Point point;
    point.getVector3fMap() = place.cast<float>();
    point.getNormalVector3fMap() = normal.cast<float>();
    return point;
  }

  SurfaceQuery query_;
  Eigen::Matrix3Xd normals_;  ///< of the triangles
  double max_distance_;       ///< [mm]
  Eigen::Vector3d centre_;
  double scale_;  ///< local = (world - centre) * scale
};

/// The motion of the local frame that brings the points nearest to the feet, or to their planes.
Eigen::Isometry3d estimate_motion(const Pairs& pairs, bool to_planes) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (to_planes) {
    const pcl::registration::TransformationEstimationPointToPlaneLLS<Point, Point, double> planes;
    planes.estimateRigidTransformation(pairs.points, pairs.feet, matrix);
  } else {
    const pcl::registration::TransformationEstimationSVD<Point, Point, double> feet;
    feet.estimateRigidTransformation(pairs.points, pairs.feet, matrix);
  }
  Eigen::Isometry3d motion;
  motion.linear() = Eigen::Quaterniond(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>()))
                        .normalized()
                        .toRotationMatrix();
  motion.translation() = matrix.topRightCorner<3, 1>();
  return motion;
}

Eigen::Matrix3Xd finite_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  Eigen::Matrix3Xd finite(3, points.cols());
  Eigen::Index count = 0;
  for (const auto& point : points.colwise()) {
    if (point.allFinite()) finite.col(count++) = point;
  }
  finite.conservativeResize(3, count);
  return finite;
}

void check_options(const RegistrationOptions& options) {
  if (options.max_iterations < 1) {
    throw InvalidInput("register_points: max_iterations is " +
                       std::to_string(options.max_iterations) + "; it must be >= 1");
  }
  if (!(options.max_correspondence > 0)) {
    throw InvalidInput("register_points: max_correspondence is " +
                       std::to_string(options.max_correspondence) +
                       " of the target's diagonal; it must be > 0");
  }
}

}  // namespace

Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                             const TriangleMesh& target, const RegistrationOptions& options) {
  check_options(options);
  check_mesh(target, "register_points: the target");
  const Eigen::Matrix3Xd source = finite_points(points);
  if (source.cols() < kMinPairs) {
    throw InvalidInput("register_points: " + std::to_string(source.cols()) + " of the " +
                       std::to_string(points.cols()) +
                       " points are finite; at least three are needed");
  }
  const Target surface(target, options.max_correspondence * bounding_diagonal(target));

  Registration result;
  bool is_near = false;
  Pairs pairs = surface.pair(source);
  for (int i = 0; i < options.max_iterations; ++i) {
    if (pairs.points.size() < kMinPairs) {
      result.stop = RegistrationStop::too_few_pairs;
      break;
    }
    const Eigen::Isometry3d motion = estimate_motion(pairs, is_near && pairs.planes_fix_pose);
    result.T_target_source = surface.to_world(motion) * result.T_target_source;
    pairs = surface.pair(result.T_target_source * source);
    const double change = Eigen::AngleAxisd(motion.linear()).angle() + motion.translation().norm();
    if (is_near && change <= kConverged) {
      result.stop = RegistrationStop::converged;
      break;
    }
    is_near = is_near || change <= kNear;
  }
  result.pairs = static_cast<int>(pairs.points.size());
  result.rms = std::sqrt(pairs.sum_of_squares / result.pairs);
  return result;
}

}  // namespace palpate::geometry
