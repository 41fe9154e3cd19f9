// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "calibration/corner_fit.h"
#include "palpate/sensing/board_views.h"

namespace palpate::sensing {

/// The inner corners of a board that are seen in an image.
struct FoundBoard {
  Eigen::Matrix2Xd board;    ///< 2 x N [mm] in the plane of the board
  Eigen::Matrix2Xd corners;  ///< 2 x N [px]
  int window = 0;            ///< px, half the side of the squares in which corners are refined
  double blur = 0;           ///< px, standard deviation; 0 if unknown
};

/// Finds a board without markers, which must be complete, in `gray` (8 bit), and refines its
/// corners in `fine`, which shows the same. A part of it is not sufficient: it does not show which
/// part it is, and OpenCV's detector of parts invents corners beyond the edge of the picture.
[[nodiscard]] std::optional<FoundBoard> find_chessboard(const cv::Mat& gray,
                                                        const cv::Mat_<float>& fine,
                                                        const Board& board);

/// The same for a ChArUco board, `board.marker` > 0, of whose corners those beside two markers are
/// found. A corner that contradicts the others, as of a marker misread, is left out.
[[nodiscard]] std::optional<FoundBoard> find_charuco_board(const cv::Mat& gray,
                                                           const cv::Mat_<float>& fine,
                                                           const Board& board);

/// Calls one of the two functions, as the board requires.
[[nodiscard]] std::optional<FoundBoard> find_printed_board(const cv::Mat& gray,
                                                           const cv::Mat_<float>& fine,
                                                           const Board& board);

/// The start of the refinement of a corner.
/// \param along, down steps along the edges by one square [px].
/// \param nearest distance of the next edge that is not the corner's own [squares].
[[nodiscard]] CornerGuess corner_guess(const Eigen::Vector2d& place, const Eigen::Vector2d& along,
                                       const Eigen::Vector2d& down, double nearest);

/// Refines a corner from a third of a pixel, the error of the detector, to some hundredths of one
/// by the balance of gradients around it, and then by `fit_corner`, if that can be applied.
/// \return with blur 0 if not.
[[nodiscard]] CornerFit refine_corner(const cv::Mat_<float>& image, CornerGuess guess);

}  // namespace palpate::sensing
