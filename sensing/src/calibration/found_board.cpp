// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/found_board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "files/storage_file.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// Mean brightness in the middle of the square whose first corner is in `row`, `column`.
double brightness(const cv::Mat& gray, const std::vector<cv::Point2f>& corners, const Board& board,
                  int row, int column) {
  const auto at = [&](int r, int c) {
    return corners[static_cast<std::size_t>(r * board.columns + c)];
  };
  const cv::Point2f middle = 0.25F * (at(row, column) + at(row, column + 1) + at(row + 1, column) +
                                      at(row + 1, column + 1));
  const int x = std::clamp(cvRound(middle.x), 1, gray.cols - 2);
  const int y = std::clamp(cvRound(middle.y), 1, gray.rows - 2);
  return cv::mean(gray(cv::Rect(x - 1, y - 1, 3, 3)))[0];
}

/// Sorts corners into the order of the board: not mirrored, and with a white square after the first
/// corner, which is unique if one count is odd and the other even.
void set_order(const cv::Mat& gray, std::vector<cv::Point2f>& corners, const Board& board) {
  const cv::Point2f along_row = corners[static_cast<std::size_t>(board.columns - 1)] - corners[0];
  const cv::Point2f down =
      corners[corners.size() - static_cast<std::size_t>(board.columns)] - corners[0];
  if (along_row.cross(down) < 0) {
    for (auto row = corners.begin(); row != corners.end(); row += board.columns)
      std::reverse(row, row + board.columns);
  }
  double white = 0;
  double black = 0;
  for (int row = 0; row + 1 < board.rows; ++row) {
    for (int column = 0; column + 1 < board.columns; ++column)
      ((row + column) % 2 == 0 ? white : black) += brightness(gray, corners, board, row, column);
  }
  if (white < black) std::reverse(corners.begin(), corners.end());
}

/// Steps from a corner to its neighbours along a row and a column of the board [px].
std::pair<Eigen::Vector2d, Eigen::Vector2d> steps_from(const Eigen::Matrix2Xd& corners,
                                                       const Board& board, Eigen::Index i) {
  const Eigen::Index column = i % board.columns;
  const Eigen::Index row = i / board.columns;
  const Eigen::Index left = i - (column > 0 ? 1 : 0);
  const Eigen::Index right = i + (column + 1 < board.columns ? 1 : 0);
  const Eigen::Index above = i - (row > 0 ? board.columns : 0);
  const Eigen::Index below = i + (row + 1 < board.rows ? board.columns : 0);
  return {(corners.col(right) - corners.col(left)) / static_cast<double>(right - left),
          (corners.col(below) - corners.col(above)) /
              static_cast<double>((below - above) / board.columns)};
}

/// Radius of the circle around a corner that no edge beyond `nearest` [px] reaches.
double corner_radius(double nearest) {
  constexpr double kShare = 0.8;  // of the distance: squares shrink with perspective
  constexpr double kBlur = 2.5;   // px
  constexpr double kLeast = 3;    // px
  constexpr double kMost = 16;    // px; farther off, the curvature of lens distortion matters
  return std::clamp(kShare * nearest - kBlur, kLeast, kMost);
}

}  // namespace

CornerGuess corner_guess(const Eigen::Vector2d& place, const Eigen::Vector2d& along,
                         const Eigen::Vector2d& down, double nearest) {
  const double area = std::abs(along.x() * down.y() - along.y() * down.x());
  return {
      place, {along, down}, corner_radius(nearest * area / std::max(along.norm(), down.norm()))};
}

CornerFit refine_corner(const cv::Mat_<float>& image, CornerGuess guess) {
  const int half = std::max(2, static_cast<int>(0.6 * guess.radius));
  constexpr int kMostSteps = 50;
  constexpr double kLastStep = 1e-4;  // px, far below a corner's noise
  std::vector<cv::Point2f> corner{
      {static_cast<float>(guess.place.x()), static_cast<float>(guess.place.y())}};
  cv::cornerSubPix(image, corner, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMostSteps, kLastStep});
  guess.place << corner[0].x, corner[0].y;
  return fit_corner(image, guess).value_or(CornerFit{guess.place});
}

std::optional<FoundBoard> find_chessboard(const cv::Mat& gray, const cv::Mat_<float>& fine,
                                          const Board& board) {
  std::vector<cv::Point2f> found;
  const QuietOpenCv quiet;
  if (!cv::findChessboardCornersSB(
          gray, cv::Size(board.columns, board.rows), found,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY)) {
    return std::nullopt;
  }
  set_order(gray, found, board);
  FoundBoard result{.board = board_corners(board), .corners = board_corners(board)};
  for (std::size_t i = 0; i < found.size(); ++i)
    result.corners.col(static_cast<Eigen::Index>(i)) << found[i].x, found[i].y;
  Eigen::Matrix2Xd refined = result.corners;
  std::vector<double> blurs;
  for (Eigen::Index i = 0; i < refined.cols(); ++i) {
    const auto [along, down] = steps_from(result.corners, board, i);
    constexpr double kNextEdge = 1;  // squares
    const CornerGuess guess = corner_guess(refined.col(i), along, down, kNextEdge);
    result.window = std::max(result.window, static_cast<int>(guess.radius));
    const CornerFit fit = refine_corner(fine, guess);
    refined.col(i) = fit.place;
    blurs.push_back(fit.blur);
  }
  result.blur = median(blurs);
  result.corners = refined;
  return result;
}

std::optional<FoundBoard> find_printed_board(const cv::Mat& gray, const cv::Mat_<float>& fine,
                                             const Board& board) {
  return board.marker > 0 ? find_charuco_board(gray, fine, board)
                          : find_chessboard(gray, fine, board);
}

}  // namespace palpate::sensing
