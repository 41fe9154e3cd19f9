// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/sensing/image_size.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_view.h"

namespace palpate::sensing {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct RigCalibrationOptions {
  int distortion_terms = 4;  ///< 0, 2, 4 or 5
  double max_residual_ratio = 4;
  double max_focal_deviation = 0.02;
  /// Parallel boards determine the focal length only through lens distortion, which noise can
  /// imitate.
  double min_tilt = 10 * std::numbers::pi / 180;
};

void visit(RigCalibrationOptions& options, FieldVisitor& visitor);

/// \throws InvalidInput if an option is outside its range.
void check_rig_calibration(const RigCalibrationOptions& options);

/// Standard deviations of the parameters of a camera.
struct CameraDeviation {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px
  std::array<double, 5> distortion{};     ///< k1 k2 p1 p2 k3; 0 where not estimated
};

struct ViewResiduals {
  std::string name;
  double camera_rms = 0;     ///< px, root of the mean squared length of the residuals
  double projector_rms = 0;  ///< px
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();  ///< mm
  Eigen::Matrix2Xd camera;              ///< 2 x N [px], these points in the camera's image
  Eigen::Matrix2Xd camera_residual;     ///< 2 x N [px], observed minus predicted
  Eigen::Matrix2Xd projector;           ///< 2 x M [px]
  Eigen::Matrix2Xd projector_residual;  ///< 2 x M [px], observed minus predicted
};

struct RejectedView {
  std::string name;
  std::string reason;  ///< in words, with figures
};

struct RigCalibration {
  Rig rig;  ///< with its covariance
  /// Median standard deviation of depths by the rig's covariance, as a share of the depth: over the
  /// camera's image, at the distances of the boards.
  double depth_deviation = 0;
  /// Parameters that the views determine badly: name, standard deviation, and which pose to add.
  std::vector<std::string> advice;
  CameraDeviation camera_deviation;
  CameraDeviation projector_deviation;
  Eigen::Vector3d rotation_deviation = Eigen::Vector3d::Zero();     ///< rad, about x, y, z
  Eigen::Vector3d translation_deviation = Eigen::Vector3d::Zero();  ///< mm
  double camera_rms = 0;                                            ///< px, over all points
  double projector_rms = 0;                                         ///< px, over all points
  /// px, over the points of both: the re-projection error of OpenCV's stereoCalibrate.
  double stereo_rms = 0;
  std::vector<ViewResiduals> views;  ///< the views that were used, in input order
  std::vector<RejectedView> rejected;
};

/// Calibrates the intrinsics of camera and projector and the pose between them from views of a flat
/// board.
///
/// Each lens is first calibrated alone (Zhang 2000, by OpenCV), with the projector as an inverse
/// camera (Moreno and Taubin 2012). Then all parameters and board poses are refined together: a lit
/// point is where the camera's ray meets the board, and must be where the projector's ray does.
/// Each instrument is weighted by the inverse of its residual variance, and points with residuals
/// above three standard deviations lose weight. The standard deviations cover errors that differ
/// from point to point, not a board that is not flat. The order of the views does not matter.
/// \throws InvalidInput if views are malformed or an option is outside its range.
/// \throws SolverError if fewer than three views remain or the views do not determine the
/// parameters, for example because all boards are parallel. The message tells what to show.
[[nodiscard]] RigCalibration calibrate_rig(const std::vector<RigView>& views,
                                           const ImageSize& camera, const ImageSize& projector,
                                           const RigCalibrationOptions& options = {});

}  // namespace palpate::sensing
