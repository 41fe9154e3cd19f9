// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/rigid_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/rigid_motion.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/robust_weights.h"

namespace palpate::geometry {
namespace {

/// Sums are computed per block, and blocks are added in order, so that threads do not affect them.
constexpr Eigen::Index kBlock = 2048;

/// Part of a problem: pairs [begin, end).
void add_pairs(const Eigen::Matrix3Xd& points, const Pairing& pairing, double deviation,
               Eigen::Index begin, Eigen::Index end, RigidProblem& sum) {
  Eigen::Vector3d arms = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = begin; i < end; ++i) {
    if (!pairing.usable[i]) continue;
    const double weight = tukey_weight(pairing.distances[i], deviation);
    if (!(weight > 0)) continue;
    const Eigen::Vector3d arm = (points.col(i) - sum.centre) / sum.radius;
    const Eigen::Vector3d normal = pairing.normals.col(i);
    Vector6d row;
    row << arm.cross(normal), normal;
    const Vector6d weighted = weight * row;
    sum.planes.noalias() += weighted * row.transpose();
    sum.slope += weight * pairing.heights[i] * row;
    arms += weight * arm;
    spread.noalias() += (weight * arm).eval() * arm.transpose();
    sum.weight += weight;
    const double root = std::sqrt(weight);
    sum.curvature += root * (5 * root - 4);
    ++sum.used;
  }
  sum.points.topLeftCorner<3, 3>() += spread.trace() * Eigen::Matrix3d::Identity() - spread;
  sum.points.topRightCorner<3, 3>() += cross_matrix(arms);
}

}  // namespace

void Pairing::resize(Eigen::Index count) {
  normals.resize(3, count);
  heights.resize(count);
  distances.resize(count);
  usable.resize(count);
}

RigidProblem rigid_problem(const Eigen::Matrix3Xd& points, const Pairing& pairing,
                           double deviation) {
  RigidProblem problem;
  problem.centre = points.rowwise().mean();
  problem.radius = std::sqrt((points.colwise() - problem.centre).colwise().squaredNorm().mean());
  if (!(problem.radius > 0)) problem.radius = 1;  // all points coincide: rotations move nothing
  const Eigen::Index blocks = (points.cols() + kBlock - 1) / kBlock;
  if (blocks == 1) {
    add_pairs(points, pairing, deviation, 0, points.cols(), problem);
  } else {
    std::vector<RigidProblem> parts(static_cast<size_t>(blocks), problem);
    parallel_for(blocks, [&](Eigen::Index block) {
      add_pairs(points, pairing, deviation, block * kBlock,
                std::min(points.cols(), (block + 1) * kBlock), parts[static_cast<size_t>(block)]);
    });
    for (const RigidProblem& part : parts) {
      problem.planes += part.planes;
      problem.points += part.points;
      problem.slope += part.slope;
      problem.weight += part.weight;
      problem.curvature += part.curvature;
      problem.used += part.used;
    }
  }
  problem.points.bottomLeftCorner<3, 3>() = problem.points.topRightCorner<3, 3>().transpose();
  problem.points.bottomRightCorner<3, 3>() = problem.weight * Eigen::Matrix3d::Identity();
  return problem;
}

Vector6d solve(const RigidProblem& problem, double stay) {
  // The normal equations square the condition number, which `stay` bounds.
  Matrix6d equations = problem.planes + stay * problem.points;
  // Points on a line can rotate about it without moving.
  constexpr double kIdle = 1e-6;
  equations.diagonal().array() += kIdle * stay * problem.weight;
  return equations.ldlt().solve(-problem.slope);
}

Eigen::Isometry3d to_motion(const Vector6d& x, const RigidProblem& problem) {
  const Eigen::Vector3d turn = x.head<3>() / problem.radius;
  const double angle = turn.norm();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  motion.translation() = problem.centre + x.tail<3>() - motion.linear() * problem.centre;
  return motion;
}

}  // namespace palpate::geometry
