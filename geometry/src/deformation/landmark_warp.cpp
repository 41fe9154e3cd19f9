// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/landmark_warp.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace palpate::geometry {
namespace {

// Directions that the landmarks do not span, such as the normal of a plane that contains them, have
// pivots below this, relative to the largest. Measured positions are no more exact.
constexpr double kSpan = 1e-3;

// Points that are warped in one step. With hundreds of landmarks, the kernel of all points at once
// would take more memory than everything else.
constexpr Eigen::Index kWarpedAtOnce = 256;

// Distances of points from landmarks, N x L.
Eigen::MatrixXd kernel(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& landmarks) {
  Eigen::MatrixXd result(points.cols(), landmarks.cols());
  for (Eigen::Index k = 0; k < landmarks.cols(); ++k)
    result.col(k) = (points.colwise() - landmarks.col(k)).colwise().norm().transpose();
  return result;
}

// A point's affine coordinates, N x 4.
Eigen::MatrixXd affine(const Eigen::Matrix3Xd& points) {
  Eigen::MatrixXd result(points.cols(), 4);
  result << Eigen::VectorXd::Ones(points.cols()), points.transpose();
  return result;
}

}  // namespace

Eigen::Matrix3Xd warp_by_landmarks(const Eigen::Matrix3Xd& points, const Landmarks& landmarks) {
  const Eigen::Matrix4d similarity = Eigen::umeyama(landmarks.source, landmarks.target, true);
  const auto moved = [&](const Eigen::Matrix3Xd& p) {
    return Eigen::Matrix3Xd((similarity.topLeftCorner<3, 3>() * p).colwise() +
                            similarity.topRightCorner<3, 1>());
  };
  // Centre on the landmarks and scale by their spread, so that the threshold of the rank applies.
  const Eigen::Vector3d middle = landmarks.target.rowwise().mean();
  const double spread = (landmarks.target.colwise() - middle).norm() /
                        std::sqrt(static_cast<double>(landmarks.target.cols()));
  const auto normalised = [&](const Eigen::Matrix3Xd& p) {
    return Eigen::Matrix3Xd((p.colwise() - middle) / spread);
  };
  const Eigen::Matrix3Xd at_similarity = moved(points);
  const Eigen::Matrix3Xd from = moved(landmarks.source);
  const Eigen::Matrix3Xd nodes = normalised(from);

  // The affine map comes first. The spline then only fits the remaining error.
  const Eigen::MatrixXd P = affine(nodes);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> span;
  span.setThreshold(kSpan);
  span.compute(P);
  const Eigen::MatrixXd left = (landmarks.target - from).transpose();
  const Eigen::MatrixXd linear = span.solve(left);
  const Eigen::MatrixXd rest = left - P * linear;
  const Eigen::Index count = nodes.cols();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(count + 4, count + 4);
  K.topLeftCorner(count, count) = kernel(nodes, nodes);
  K.topRightCorner(count, 4) = P;
  K.bottomLeftCorner(4, count) = P.transpose();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + 4, 3);
  right.topRows(count) = rest;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> system;
  system.setThreshold(kSpan * kSpan);
  system.compute(K);
  const Eigen::MatrixXd spline = system.solve(right);

  Eigen::Matrix3Xd warped = at_similarity;
  for (Eigen::Index first = 0; first < warped.cols(); first += kWarpedAtOnce) {
    const Eigen::Index size = std::min(kWarpedAtOnce, warped.cols() - first);
    const Eigen::Matrix3Xd places = normalised(at_similarity.middleCols(first, size));
    warped.middleCols(first, size) += (affine(places) * (linear + spline.bottomRows(4)) +
                                       kernel(places, nodes) * spline.topRows(count))
                                          .transpose();
  }
  return warped;
}

}  // namespace palpate::geometry
