// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate::geometry {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Vector<double, 6>;

/// Points with the planes of the surface at their nearest points (feet), one column per point.
struct Pairing {
  Eigen::Matrix3Xd normals;                      ///< of the surface at the feet
  Eigen::VectorXd heights;                       ///< of the points above the planes, signed
  Eigen::VectorXd distances;                     ///< from the points to the feet
  Eigen::Array<bool, Eigen::Dynamic, 1> usable;  ///< false if the point lies beside the surface

  void resize(Eigen::Index count);
};

/// The weighted point-to-plane problem at one pose. A small motion of the points is a 6-vector of
/// lengths (rotation about `centre` times `radius`, translation), so that a unit of each component
/// moves the points by about the same length.
struct RigidProblem {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of the points
  double radius = 0;  ///< root mean square of their distances from it
  Matrix6d planes =
      Matrix6d::Zero();  ///< sum of w j j^T, j: derivative of the distance to the plane
  Matrix6d points = Matrix6d::Zero();  ///< sum of w J^T J, J: derivative of the point
  Vector6d slope = Vector6d::Zero();   ///< sum of w j e, e: distance to the plane
  double weight = 0;                   ///< sum of w
  double curvature = 0;                ///< sum of the second derivatives of Tukey's loss; <= weight
  int used = 0;                        ///< pairs with w > 0
};

[[nodiscard]] RigidProblem rigid_problem(const Eigen::Matrix3Xd& points, const Pairing& pairing,
                                         double deviation);

/// The motion that minimises sum of w ((e + j x)^2 + stay |J x|^2). `stay` > 0 prevents unnecessary
/// motion along the surface. Precondition: `problem.used` >= 3, and the points differ.
[[nodiscard]] Vector6d solve(const RigidProblem& problem, double stay);

/// The rigid motion with these coordinates, in the frame of the points.
[[nodiscard]] Eigen::Isometry3d to_motion(const Vector6d& x, const RigidProblem& problem);

}  // namespace palpate::geometry
