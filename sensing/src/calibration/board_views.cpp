// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/board_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "calibration/corner_fit.h"
#include "calibration/lit_grid.h"
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

/// Refines a corner from a third of a pixel, the error of the detector, to some hundredths of one
/// by the balance of gradients around it, and then by `fit_corner`, if that can be applied.
Eigen::Vector2d refine(const cv::Mat_<float>& image, CornerGuess guess) {
  const int half = std::max(2, static_cast<int>(0.6 * guess.radius));
  constexpr int kMostSteps = 50;
  constexpr double kLastStep = 1e-4;  // px, far below a corner's noise
  std::vector<cv::Point2f> corner{
      {static_cast<float>(guess.place.x()), static_cast<float>(guess.place.y())}};
  cv::cornerSubPix(image, corner, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMostSteps, kLastStep});
  guess.place << corner[0].x, corner[0].y;
  return fit_corner(image, guess).value_or(guess.place);
}

/// A complete board in an image.
struct FoundBoard {
  Eigen::Matrix2Xd corners;  ///< 2 x (columns * rows) [px]
  int window = 0;            ///< px, half the side of the squares that tell where the corners are
};

/// Steps from a corner to its neighbours along a row and a column of the board [px].
std::pair<Eigen::Vector2d, Eigen::Vector2d> edges_at(const Eigen::Matrix2Xd& corners,
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

/// Radius of the circle around a corner that no edge of the next squares reaches [px].
double free_radius(const Eigen::Vector2d& along, const Eigen::Vector2d& down) {
  constexpr double kShare = 0.8;  // of the distance: squares shrink with perspective
  constexpr double kBlur = 2.5;   // px
  constexpr double kLeast = 3;    // px
  constexpr double kMost = 16;    // px; farther off, the curvature of lens distortion matters
  const double area = std::abs(along.x() * down.y() - along.y() * down.x());
  const double nearest = area / std::max(along.norm(), down.norm());
  return std::clamp(kShare * nearest - kBlur, kLeast, kMost);
}

/// Finds the corners in `gray` (8 bit), and refines them in `fine` (CV_32F), which shows the same:
/// first by the balance of gradients, then by `fit_corner`.
std::optional<FoundBoard> find_corners(const cv::Mat& gray, const cv::Mat_<float>& fine,
                                       const Board& board) {
  std::vector<cv::Point2f> found;
  const QuietOpenCv quiet;
  if (!cv::findChessboardCornersSB(
          gray, cv::Size(board.columns, board.rows), found,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY)) {
    return std::nullopt;
  }
  set_order(gray, found, board);
  FoundBoard result{Eigen::Matrix2Xd(2, static_cast<Eigen::Index>(found.size())), 0};
  for (std::size_t i = 0; i < found.size(); ++i)
    result.corners.col(static_cast<Eigen::Index>(i)) << found[i].x, found[i].y;
  Eigen::Matrix2Xd refined = result.corners;
  for (Eigen::Index i = 0; i < refined.cols(); ++i) {
    const auto [along, down] = edges_at(result.corners, board, i);
    const double radius = free_radius(along, down);
    result.window = std::max(result.window, static_cast<int>(radius));
    refined.col(i) = refine(fine, {refined.col(i), {along, down}, radius});
  }
  result.corners = refined;
  return result;
}

/// Mean of a sequence of images and their inverses: the evenly lit board, with less noise than any
/// image has. In grey levels of 8 bit.
cv::Mat_<float> mean_image(const std::vector<cv::Mat>& images) {
  cv::Mat_<float> sum(images[0].size(), 0.0F);
  for (const cv::Mat& image : images) cv::accumulate(image, sum);
  const double full_scale = images[0].depth() == CV_8U ? 1 : 257;
  sum /= full_scale * static_cast<double>(images.size());
  return sum;
}

/// Non-zero where the camera sees the squares of a board.
cv::Mat_<uchar> squares_of(const FoundBoard& found, const Board& board, const cv::Size& size) {
  std::vector<cv::Point2d> from, to;
  const Eigen::Matrix2Xd points = board_corners(board);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    from.emplace_back(points(0, i), points(1, i));
    to.emplace_back(found.corners(0, i), found.corners(1, i));
  }
  constexpr double kAround = 0.9;  // of the outer squares; the distortion of the lens is not known
  const double low = -kAround * board.square;
  const double right = (board.columns - 1 + kAround) * board.square;
  const double bottom = (board.rows - 1 + kAround) * board.square;
  std::vector<cv::Point2d> outline{{low, low}, {right, low}, {right, bottom}, {low, bottom}};
  cv::perspectiveTransform(outline, outline, cv::findHomography(from, to));
  std::vector<cv::Point> polygon;
  for (const cv::Point2d& corner : outline) polygon.emplace_back(corner);
  cv::Mat_<uchar> mask(size, 0);
  cv::fillConvexPoly(mask, polygon, cv::Scalar(255));
  return mask;
}

/// Whether the panel lights all of the window around a corner. At the edge of the light, the corner
/// would be pulled towards it.
bool is_lit(const Eigen::Vector2d& corner, int window, const Eigen::Matrix3d& homography,
            const ImageSize& panel) {
  constexpr double kMargin = 4;  // px of the panel: blur, and the distortion of both lenses
  for (const double dx : {-window, window}) {
    for (const double dy : {-window, window}) {
      const Eigen::Vector3d place = homography * (corner + Eigen::Vector2d(dx, dy)).homogeneous();
      const Eigen::Vector2d lamp = place.hnormalized();
      if (!(lamp.minCoeff() >= kMargin && lamp.x() <= panel.width - 1 - kMargin &&
            lamp.y() <= panel.height - 1 - kMargin))
        return false;
    }
  }
  return true;
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
  const auto found = find_corners(gray, cv::Mat_<float>(gray), board);
  return found ? std::optional(found->corners) : std::nullopt;
}

RigView view_from_gray_code(const std::vector<cv::Mat>& images, const Board& printed,
                            const ImageSize& projector, const BoardViewOptions& options) {
  check_board(printed);
  const cv::Mat_<cv::Vec2f> places =
      decode_gray_code(images, projector, {.min_contrast = options.min_contrast});
  RigView view;
  const auto found = find_corners(as_gray8(images[images.size() - 2]), mean_image(images), printed);
  if (!found) return view;
  view.board = board_corners(printed);
  view.camera = found->corners;
  const auto grid =
      find_lit_grid(images, places, squares_of(*found, printed, places.size()), projector);
  if (!grid) return view;
  view.lit_camera = grid->camera;
  view.projector = grid->projector;
  Eigen::Index lit = 0;
  for (Eigen::Index i = 0; i < view.board.cols(); ++i) {
    if (!is_lit(view.camera.col(i), found->window, grid->homography, projector)) continue;
    view.board.col(lit) = view.board.col(i).eval();
    view.camera.col(lit++) = view.camera.col(i).eval();
  }
  view.board.conservativeResize(Eigen::NoChange, lit);
  view.camera.conservativeResize(Eigen::NoChange, lit);
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
