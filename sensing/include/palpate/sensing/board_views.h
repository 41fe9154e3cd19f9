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

/// A chessboard. One count of inner corners should be odd and the other even, so that it looks
/// different upside down.
struct Board {
  int columns = 0;    ///< inner corners along x, >= 3
  int rows = 0;       ///< inner corners along y, >= 3
  double square = 0;  ///< side of a square, > 0: mm on paper, px on a panel
};

/// The inner corners, row after row, from (0, 0) on: 2 x (columns * rows).
/// \throws InvalidInput on a bad board.
[[nodiscard]] Eigen::Matrix2Xd board_corners(const Board& board);

/// The board that a projector shows as one still image: black on white, with a margin of one
/// square. Inner corners 9 x 6, or 8 x 5 if the printed board has 9 x 6, so that the two cannot be
/// mistaken. \throws InvalidInput if the panel is too small for it.
[[nodiscard]] Board projected_board(const ImageSize& panel, const Board& printed);
/// Its corners on the panel: 2 x (columns * rows) [px].
[[nodiscard]] Eigen::Matrix2Xd projected_corners(const ImageSize& panel, const Board& board);
/// Its picture: 8 bit, 0 or 255.
[[nodiscard]] cv::Mat draw_projected_board(const ImageSize& panel, const Board& board);

/// Inner corners of a chessboard in an image of 8 or 16 bit, in the order of `board_corners`: 2 x
/// (columns * rows) [px], the first one where the corner of a black square of the board lies;
/// nothing if the board is not there as a whole.
/// \throws InvalidInput on a bad board or image.
[[nodiscard]] std::optional<Eigen::Matrix2Xd> find_board(const cv::Mat& image, const Board& board);

struct BoardViewOptions {
  /// Pixels of the Gray code count from this contrast on: `GrayCodeOptions`.
  double min_contrast = 0.03;
  /// The homography around a corner is fitted to pixels within so many sides of a square; in
  /// [0.25, 4].
  double window = 1;
  /// A corner's place on the panel is accepted iff this share of its window agrees; in (0, 1).
  double min_agreement = 0.5;
};

/// A view from a Gray code sequence, in the order of `draw_gray_code`: the board is found in the
/// white image; each corner's place on the panel comes from a homography around it (Moreno and
/// Taubin 2012), robust against wrong codes, so that it is finer than a projector pixel. Corners
/// that cannot be decoded are left out; a view without a board has no points at all.
/// \throws InvalidInput as `decode_gray_code` and `find_board`, or on an option outside its range.
[[nodiscard]] RigView view_from_gray_code(const std::vector<cv::Mat>& images, const Board& printed,
                                          const ImageSize& projector,
                                          const BoardViewOptions& options = {});

/// A view from two pictures of one pose: `board` shows the printed board, `projected` the board of
/// `projected_board`, cast onto the same plane beside it. They may be the same picture.
[[nodiscard]] RigView view_from_still(const cv::Mat& board, const cv::Mat& projected,
                                      const Board& printed, const ImageSize& projector);

}  // namespace palpate::sensing
