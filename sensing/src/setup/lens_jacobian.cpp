// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/lens_jacobian.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

namespace palpate::sensing {

LensView look(const geometry::Camera& lens, const Eigen::Matrix3Xd& points) {
  const cv::Matx33d matrix(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const auto& d = lens.distortion;
  const cv::Vec<double, 5> distortion(d[0], d[1], d[2], d[3], d[4]);
  const auto count = static_cast<int>(points.cols());
  LensView view{Eigen::Matrix2Xd(2, count), Eigen::MatrixXd(2 * count, kLensParameters),
                Eigen::MatrixXd(2 * count, kMoveParameters)};
  if (count == 0) return view;
  const cv::Mat objects(count, 1, CV_64FC3, const_cast<double*>(points.data()));
  cv::Mat_<cv::Vec2d> pixels;
  cv::Mat_<double> jacobian;
  // With zero rotation and translation their columns are the derivatives by a motion of the points.
  cv::projectPoints(objects, cv::Vec3d(), cv::Vec3d(), matrix, distortion, pixels, jacobian);
  for (int i = 0; i < count; ++i) view.predicted.col(i) << pixels(i)[0], pixels(i)[1];
  for (int row = 0; row < 2 * count; ++row) {
    for (int column = 0; column < kMoveParameters; ++column)
      view.by_move(row, column) = jacobian(row, column);
    for (int column = 0; column < kLensParameters; ++column)
      view.by_lens(row, column) = jacobian(row, kMoveParameters + column);
  }
  return view;
}

RayView look_back(const geometry::Camera& lens, const Eigen::Matrix2Xd& pixels) {
  RayView view{Eigen::Matrix3Xd(3, pixels.cols()), {}};
  for (Eigen::Index i = 0; i < pixels.cols(); ++i)
    view.rays.col(i) = geometry::undistort(lens, pixels.col(i)).homogeneous();
  const LensView there = look(lens, view.rays);
  view.by_lens.resize(2 * pixels.cols(), kLensParameters);
  for (Eigen::Index i = 0; i < pixels.cols(); ++i) {
    // The pixel stays: the ray must compensate its move by the parameters.
    const Eigen::Matrix2d by_ray = there.by_move.block<2, 2>(2 * i, 3);
    view.by_lens.middleRows<2>(2 * i) = -by_ray.inverse() * there.by_lens.middleRows<2>(2 * i);
  }
  return view;
}

}  // namespace palpate::sensing
