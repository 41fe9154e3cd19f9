// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_calibration.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "files/storage_file.h"
#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

int fixed_terms(int distortion_terms) {
  int flags = cv::CALIB_USE_LU;  // for each step; the default, SVD, takes far longer
  if (distortion_terms < 5) flags |= cv::CALIB_FIX_K3;
  if (distortion_terms < 4) flags |= cv::CALIB_ZERO_TANGENT_DIST;
  if (distortion_terms < 2) flags |= cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2;
  return flags;
}

Eigen::Isometry3d pose_of(const cv::Mat& turn, const cv::Mat& shift) {
  cv::Matx33d matrix;
  cv::Rodrigues(turn, matrix);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d R;
  cv::cv2eigen(matrix, R);
  pose.linear() = R;
  pose.translation() << shift.at<double>(0), shift.at<double>(1), shift.at<double>(2);
  return pose;
}

}  // namespace

LensCalibration calibrate_lens(const std::vector<Eigen::Matrix2Xd>& board,
                               const std::vector<Eigen::Matrix2Xd>& pixels,
                               const geometry::Camera& lens, int distortion_terms) {
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> images;
  for (std::size_t v = 0; v < board.size(); ++v) {
    objects.emplace_back();
    images.emplace_back();
    for (Eigen::Index i = 0; i < board[v].cols(); ++i) {
      objects.back().emplace_back(static_cast<float>(board[v](0, i)),
                                  static_cast<float>(board[v](1, i)), 0.0F);
      images.back().emplace_back(static_cast<float>(pixels[v](0, i)),
                                 static_cast<float>(pixels[v](1, i)));
    }
  }
  cv::Mat_<double> matrix(3, 3, 0.0);
  cv::Mat_<double> distortion(1, 5, 0.0);
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  cv::Mat_<double> deviations;
  LensCalibration result;
  result.lens = lens;
  constexpr int kMostSteps = 100;
  constexpr double kLastStep = 1e-9;  // relative change of the parameters
  const QuietOpenCv quiet;
  try {
    result.rms = cv::calibrateCamera(
        objects, images, cv::Size(lens.width, lens.height), matrix, distortion, turns, shifts,
        deviations, cv::noArray(), cv::noArray(), fixed_terms(distortion_terms),
        cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMostSteps, kLastStep));
  } catch (const cv::Exception& error) {
    throw SolverError("no camera matrix fits the views (" + error.err + ")");
  }
  result.lens.fx = matrix(0, 0);
  result.lens.fy = matrix(1, 1);
  result.lens.cx = matrix(0, 2);
  result.lens.cy = matrix(1, 2);
  std::copy(distortion.begin(), distortion.end(), result.lens.distortion.begin());
  for (std::size_t i = 0; i < result.deviation.size(); ++i)
    result.deviation.at(i) = deviations(static_cast<int>(i));
  for (std::size_t v = 0; v < turns.size(); ++v)
    result.T_lens_board.push_back(pose_of(turns[v], shifts[v]));
  const bool is_finite = std::isfinite(result.rms) && std::isfinite(matrix(0, 0)) &&
                         std::isfinite(matrix(1, 1)) && cv::checkRange(distortion);
  if (!is_finite || !(result.lens.fx > 0) || !(result.lens.fy > 0))
    throw SolverError("no camera matrix fits the views");
  return result;
}

}  // namespace palpate::sensing
