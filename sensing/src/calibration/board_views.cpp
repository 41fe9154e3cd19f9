// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/board_views.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "files/storage_file.h"
#include "palpate/error.h"
#include "palpate/require.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

void check_board(const Board& board) {
  require("Board::columns", board.columns, at_least(3), "inner corners");
  require("Board::rows", board.rows, at_least(3), "inner corners");
  require("Board::square", board.square, above(0).finite(), "mm");
}

cv::Mat as_gray8(const cv::Mat& image) {
  if (image.empty() || (image.depth() != CV_8U && image.depth() != CV_16U) ||
      (image.channels() != 1 && image.channels() != 3)) {
    throw InvalidInput("find_board: an image of 8 or 16 bit with 1 or 3 channels is expected");
  }
  cv::Mat gray = image;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  if (gray.depth() == CV_16U) gray.convertTo(gray, CV_8U, 1.0 / 257);
  return gray;
}

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

/// Refines corners by the gradients around them. On drawn boards the error falls from 0.3 px of the
/// detector to 0.06 px.
void refine(const cv::Mat& gray, std::vector<cv::Point2f>& corners, const Board& board) {
  // The window must not reach the next corner.
  const double side = cv::norm(corners[static_cast<std::size_t>(board.columns - 1)] - corners[0]) /
                      (board.columns - 1);
  constexpr int kLeast = 2;  // px
  constexpr int kMost = 11;  // px; in a larger window the curvature of lens distortion matters
  const int half = std::clamp(static_cast<int>(0.3 * side), kLeast, kMost);
  constexpr int kMostSteps = 50;
  constexpr double kLastStep = 1e-4;  // px, far below a corner's noise
  cv::cornerSubPix(gray, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMostSteps, kLastStep});
}

/// Decoded pixels around a corner.
struct CornerWindow {
  std::vector<cv::Point2f> pixels;  ///< relative to the corner
  std::vector<cv::Point2f> places;  ///< on the panel
  double area = 0;                  ///< px^2, of all pixels
};

CornerWindow collect(const cv::Mat_<cv::Vec2f>& places, const Eigen::Vector2d& corner,
                     double half) {
  const auto low = [&](double middle) {
    return std::max(0, static_cast<int>(std::ceil(middle - half)));
  };
  const auto high = [&](double middle, int size) {
    return std::min(size - 1, static_cast<int>(std::floor(middle + half)));
  };
  CornerWindow window;
  for (int row = low(corner.y()); row <= high(corner.y(), places.rows); ++row) {
    for (int column = low(corner.x()); column <= high(corner.x(), places.cols); ++column) {
      window.area += 1;
      const cv::Vec2f& place = places(row, column);
      if (std::isnan(place[0])) continue;
      window.pixels.emplace_back(static_cast<float>(column - corner.x()),
                                 static_cast<float>(row - corner.y()));
      window.places.emplace_back(place[0], place[1]);
    }
  }
  return window;
}

/// Position on the panel that lights a corner, from a local homography.
std::optional<Eigen::Vector2d> place_of_corner(const cv::Mat_<cv::Vec2f>& places,
                                               const Eigen::Vector2d& corner, double half,
                                               double min_agreement) {
  // A code is rounded to a whole pixel, and blur can change it by one.
  constexpr double kTolerance = 1.5;  // px of the panel
  constexpr std::size_t kLeastPixels = 25;
  const CornerWindow window = collect(places, corner, half);
  if (window.pixels.size() < kLeastPixels) return std::nullopt;
  cv::Mat_<uchar> agrees;
  const cv::Mat_<double> homography =
      cv::findHomography(window.pixels, window.places, cv::RANSAC, kTolerance, agrees);
  if (homography.empty() || cv::countNonZero(agrees) < min_agreement * window.area)
    return std::nullopt;
  return Eigen::Vector2d(homography(0, 2), homography(1, 2)) / homography(2, 2);
}

/// Mean distance of neighbouring corners [px].
double spacing(const Eigen::Matrix2Xd& corners, const Board& board) {
  double sum = 0;
  for (int row = 0; row < board.rows; ++row) {
    const auto first = static_cast<Eigen::Index>(row) * board.columns;
    sum += (corners.col(first + board.columns - 1) - corners.col(first)).norm();
  }
  return sum / (static_cast<double>(board.rows) * (board.columns - 1));
}

void check_options(const BoardViewOptions& options) {
  require("BoardViewOptions::window", options.window, at_least(0.25).at_most(4), "squares");
  require("BoardViewOptions::min_agreement", options.min_agreement, above(0).below(1));
}

/// First corner of the projected board on the panel [px], a whole number.
cv::Point first_corner(const ImageSize& panel, const Board& board) {
  const int side = static_cast<int>(board.square);
  return {(panel.width - side * (board.columns - 1)) / 2,
          (panel.height - side * (board.rows - 1)) / 2};
}

}  // namespace

Eigen::Matrix2Xd board_corners(const Board& board) {
  check_board(board);
  Eigen::Matrix2Xd corners(2, static_cast<Eigen::Index>(board.columns) * board.rows);
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column)
      corners.col(static_cast<Eigen::Index>(row) * board.columns + column) << column * board.square,
          row * board.square;
  }
  return corners;
}

Board projected_board(const ImageSize& panel, const Board& printed) {
  const bool is_taken =
      (printed.columns == 9 && printed.rows == 6) || (printed.columns == 6 && printed.rows == 9);
  Board board{.columns = is_taken ? 8 : 9, .rows = is_taken ? 5 : 6};
  constexpr int kAround =
      3;  // squares in addition to the inner corners: an outer one and the margin
  const int side =
      std::min(panel.width / (board.columns + kAround), panel.height / (board.rows + kAround));
  constexpr int kLeastSide = 8;  // px: smaller squares cannot be found
  if (side < kLeastSide) {
    throw InvalidInput("projected board: a panel of " + std::to_string(panel.width) + " x " +
                       std::to_string(panel.height) + " px is too small for it");
  }
  board.square = side;
  return board;
}

Eigen::Matrix2Xd projected_corners(const ImageSize& panel, const Board& board) {
  // A corner between two pixels has the mean of their coordinates.
  const cv::Point first = first_corner(panel, board);
  return board_corners(board).colwise() + Eigen::Vector2d(first.x - 0.5, first.y - 0.5);
}

cv::Mat draw_projected_board(const ImageSize& panel, const Board& board) {
  cv::Mat image(panel.height, panel.width, CV_8U, cv::Scalar(255));
  const int side = static_cast<int>(board.square);
  const cv::Point first = first_corner(panel, board);
  for (int row = -1; row < board.rows; ++row) {
    for (int column = -1; column < board.columns; ++column) {
      if ((row + column) % 2 == 0) continue;
      image(cv::Rect(first.x + column * side, first.y + row * side, side, side)) = 0;
    }
  }
  return image;
}

std::optional<Eigen::Matrix2Xd> find_board(const cv::Mat& image, const Board& board) {
  check_board(board);
  const cv::Mat gray = as_gray8(image);
  std::vector<cv::Point2f> found;
  const QuietOpenCv quiet;
  if (!cv::findChessboardCornersSB(
          gray, cv::Size(board.columns, board.rows), found,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY)) {
    return std::nullopt;
  }
  refine(gray, found, board);
  set_order(gray, found, board);
  Eigen::Matrix2Xd corners(2, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i)
    corners.col(static_cast<Eigen::Index>(i)) << found[i].x, found[i].y;
  return corners;
}

RigView view_from_gray_code(const std::vector<cv::Mat>& images, const Board& printed,
                            const ImageSize& projector, const BoardViewOptions& options) {
  check_options(options);
  const cv::Mat_<cv::Vec2f> places =
      decode_gray_code(images, projector, {.min_contrast = options.min_contrast});
  RigView view;
  const auto corners = find_board(images[images.size() - 2], printed);
  if (!corners) return view;
  const Eigen::Matrix2Xd points = board_corners(printed);
  view.board = points;
  view.camera = *corners;
  view.lit_board.resize(2, points.cols());
  view.projector.resize(2, points.cols());
  Eigen::Index known = 0;
  const double half = options.window * spacing(*corners, printed);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto place = place_of_corner(places, corners->col(i), half, options.min_agreement);
    if (!place) continue;
    view.lit_board.col(known) = points.col(i);
    view.projector.col(known++) = *place;
  }
  view.lit_board.conservativeResize(Eigen::NoChange, known);
  view.projector.conservativeResize(Eigen::NoChange, known);
  return view;
}

RigView view_from_still(const cv::Mat& board, const cv::Mat& projected, const Board& printed,
                        const ImageSize& projector) {
  const Board shown = projected_board(projector, printed);
  const auto corners = find_board(board, printed);
  const auto lit = find_board(projected, shown);
  RigView view;
  if (corners) {
    view.board = board_corners(printed);
    view.camera = *corners;
  }
  if (lit) {
    view.projector = projected_corners(projector, shown);
    view.lit_camera = *lit;
  }
  return view;
}

}  // namespace palpate::sensing
