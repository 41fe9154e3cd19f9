// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "palpate/sensing/image_size.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_view.h"

namespace palpate::sensing {

struct RigCalibrationOptions {
  /// Coefficients of each lens distortion that are estimated: 0, 2 (k1 k2), 4 (p1 p2 too) or 5 (k3
  /// too, which only boards out to the corners of the image determine).
  int distortion_terms = 4;
  /// A view is an outlier iff one of its RMS residuals > max_residual_ratio times the median of the
  /// other views' (or of 0.1 px, if that is more); > 1.
  double max_residual_ratio = 4;
  /// The views determine a rig iff the standard deviation of every focal length <=
  /// max_focal_deviation times that length, in (0, 1), ...
  double max_focal_deviation = 0.02;
  /// ... and two of the boards are inclined to one another by >= min_tilt_deg; > 0. Parallel boards
  /// fix no focal length but for the lens distortion, which noise easily feigns.
  double min_tilt_deg = 10;
};

/// Standard deviations of a camera's parameters.
struct CameraDeviation {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px
  std::array<double, 5> distortion{};     ///< k1 k2 p1 p2 k3; 0 where not estimated
};

struct ViewResiduals {
  std::string name;
  double camera_rms = 0;     ///< px, root of the mean squared length of the residuals
  double projector_rms = 0;  ///< px
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();  ///< mm
  Eigen::Matrix2Xd camera;              ///< 2 x N [px], where the camera sees the points
  Eigen::Matrix2Xd camera_residual;     ///< 2 x N [px], seen minus predicted
  Eigen::Matrix2Xd projector;           ///< 2 x M [px]
  Eigen::Matrix2Xd projector_residual;  ///< 2 x M [px]
};

struct RejectedView {
  std::string name;
  std::string reason;  ///< in plain words, with figures
};

struct RigCalibration {
  Rig rig;
  CameraDeviation camera_deviation;
  CameraDeviation projector_deviation;
  Eigen::Vector3d rotation_deviation = Eigen::Vector3d::Zero();     ///< rad, about x, y, z
  Eigen::Vector3d translation_deviation = Eigen::Vector3d::Zero();  ///< mm
  double camera_rms = 0;                                            ///< px, over all points
  double projector_rms = 0;                                         ///< px, over all points
  /// px, over the points of both: what OpenCV's stereoCalibrate calls its re-projection error.
  double stereo_rms = 0;
  std::vector<ViewResiduals> views;  ///< those used, in the order given
  std::vector<RejectedView> rejected;
};

/// Intrinsics of camera and projector and the pose between them, from views of a flat board.
///
/// Each lens alone is calibrated first (Zhang 2000, by OpenCV), the projector as an inverse camera
/// (Moreno and Taubin 2012); then all parameters and the poses of the board together, with both
/// instruments weighted by the inverse of their residual variance. Where `lit_camera` is given, the
/// camera and the poses come from the printed points alone, and the lit points are the
/// intersections of the camera's rays with the board. The standard deviations are those of the
/// least-squares fit: they tell noise, not what the model leaves out. The order of the views does
/// not matter. \throws InvalidInput if views are malformed or an option is outside its range;
/// SolverError, saying what to show, if fewer than three views remain or they do not determine the
/// parameters, such as boards that all stand parallel.
[[nodiscard]] RigCalibration calibrate_rig(const std::vector<RigView>& views,
                                           const ImageSize& camera, const ImageSize& projector,
                                           const RigCalibrationOptions& options = {});

}  // namespace palpate::sensing
