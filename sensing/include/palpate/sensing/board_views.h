// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "palpate/sensing/image_size.h"
#include "palpate/sensing/rig_view.h"

namespace palpate::sensing {

/// A chessboard. One count of inner corners should be odd and the other even, so that the board
/// looks different when turned upside down.
///
/// With `marker` > 0 it is a ChArUco board: the white squares contain markers, which identify every
/// corner even if much of the board is hidden. The first corner square is black, and the markers
/// are the first ones of OpenCV's dictionary, row by row.
struct Board {
  int columns = 0;      ///< inner corners along x, >= 3
  int rows = 0;         ///< inner corners along y, >= 3
  double square = 0;    ///< side of a square, > 0: mm if printed, px on a panel
  double marker = 0;    ///< side of a marker [mm], < square; 0: a board without
  int marker_bits = 4;  ///< bits of a marker along each side, 4 to 7
};

/// Number of markers in each dictionary.
inline constexpr int kMostMarkers = 1000;
/// Number of markers of a ChArUco board.
[[nodiscard]] int marker_count(const Board& board);

/// Inner corners of the board, row by row, starting at (0, 0): 2 x (columns * rows).
/// \throws InvalidInput if the board is not valid.
[[nodiscard]] Eigen::Matrix2Xd board_corners(const Board& board);

/// The board that the projector shows as a still image: black on white, with a margin of one
/// square. It has 9 x 6 inner corners, or 8 x 5 if the printed board has 9 x 6, so that the two
/// boards cannot be confused.
/// \throws InvalidInput if the panel is too small.
[[nodiscard]] Board projected_board(const ImageSize& panel, const Board& printed);
/// Its corners on the panel: 2 x (columns * rows) [px].
[[nodiscard]] Eigen::Matrix2Xd projected_corners(const ImageSize& panel, const Board& board);
/// Its picture: 8 bit, 0 or 255.
[[nodiscard]] cv::Mat draw_projected_board(const ImageSize& panel, const Board& board);

/// Finds the inner corners of a chessboard in an image of 8 or 16 bit.
/// \return 2 x (columns * rows) [px] in the order of `board_corners`, where the first corner
/// belongs to a black corner square; empty if the complete board is not visible.
/// \pre the board has no markers.
/// \throws InvalidInput if the board or the image is not valid.
[[nodiscard]] std::optional<Eigen::Matrix2Xd> find_board(const cv::Mat& image, const Board& board);

struct BoardViewOptions {
  /// Lowest contrast of a decoded Gray code pixel; see `GrayCodeOptions`.
  double min_contrast = 0.03;
};

/// Makes a view from the images of a Gray code sequence, in the order of `draw_gray_code`.
///
/// The board, or the part of a ChArUco board that is seen, is detected in the white image, and its
/// corners are refined in the mean of all images, which has less noise; corners beside the edge of
/// the light are left out. The lit points are means over cells of 12 x 12 camera pixels all over
/// the board, each from the places where an image and its inverse are equally bright, so they are
/// known to a hundredth of a projector pixel. A view without a board has no points.
/// \throws InvalidInput as `decode_gray_code` and `find_board`.
[[nodiscard]] RigView view_from_gray_code(const std::vector<cv::Mat>& images, const Board& printed,
                                          const ImageSize& projector,
                                          const BoardViewOptions& options = {});

/// Makes a view from two pictures of one pose: `board` shows the printed board, or a part of
/// a ChArUco board, `projected` the still image of `projected_board` beside it on the same plane.
/// Both may be the same picture.
[[nodiscard]] RigView view_from_still(const cv::Mat& board, const cv::Mat& projected,
                                      const Board& printed, const ImageSize& projector);

}  // namespace palpate::sensing
