// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "palpate/sensing/image_size.h"

namespace palpate::sensing {

/// The image of the projector's panel on a flat board: the reference that single points are
/// compared with, and its own means over small cells of the image.
struct LitGrid {
  Eigen::Matrix2Xd camera;     ///< 2 x M [px], middles of the cells
  Eigen::Matrix2Xd projector;  ///< 2 x M [px], the panel's points there
  /// 3 x 3: camera px to panel px, without the lenses' distortion.
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();
};

/// Finds where a flat board is lit from the images of a Gray code, to a hundredth of a pixel.
///
/// Between two camera pixels at which the order of an image and its inverse changes, there is the
/// border of two pixels of the panel, for a board of any colour. All such crossings within one
/// cell are compared with a smooth map from camera to panel (a homography with cubic corrections),
/// and their robust weighted mean is one point. Pixels beside edges of the board's print or of the
/// light are left out, because blur moves the crossings there. Their move by blur where the light
/// falls off evenly is corrected.
/// \param images   of `draw_gray_code`, checked by `decode_gray_code`.
/// \param places the result of `decode_gray_code` for them.
/// \param on_board 8 bit: non-zero where the board is flat.
/// \param blur     standard deviation of the camera's blur [px]; 0 if unknown.
/// \return empty if the board has too few lit pixels.
[[nodiscard]] std::optional<LitGrid> find_lit_grid(const std::vector<cv::Mat>& images,
                                                   const cv::Mat_<cv::Vec2f>& places,
                                                   const cv::Mat_<uchar>& on_board, double blur,
                                                   const ImageSize& panel);

}  // namespace palpate::sensing
