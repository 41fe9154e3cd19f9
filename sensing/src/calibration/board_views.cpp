// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/board_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calibration/found_board.h"
#include "calibration/lit_grid.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

void check_board(const Board& board) {
  require("Board::columns", board.columns, at_least(3), "inner corners");
  require("Board::rows", board.rows, at_least(3), "inner corners");
  require("Board::square", board.square, above(0).finite(), "mm");
  if (board.marker == 0) return;
  require("Board::marker", board.marker, above(0).below(board.square), "mm");
  require("Board::marker_bits", board.marker_bits, at_least(4).at_most(7));
  require("Board: markers", marker_count(board), at_least(1).at_most(kMostMarkers));
}

cv::Mat as_gray8(const cv::Mat& image) {
  if (!is_frame(image)) {
    throw InvalidInput("find_board: an image of 8 or 16 bit with 1 or 3 channels is expected");
  }
  cv::Mat gray = image;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  if (gray.depth() == CV_16U) gray.convertTo(gray, CV_8U, 1.0 / 257);
  return gray;
}

/// Mean of a sequence of images and their inverses: the evenly lit board, with less noise than any
/// image has. In grey levels of 8 bit.
cv::Mat_<float> mean_image(const std::vector<cv::Mat>& images) {
  cv::Mat_<float> sum(images[0].size(), 0.0F);
  for (const cv::Mat& image : images) cv::accumulate(image, sum);
  const double per_level = images[0].depth() == CV_8U ? 1 : 257;
  sum /= per_level * static_cast<double>(images.size());
  return sum;
}

/// Non-zero at the pixels that show the squares around the corners that were found.
cv::Mat_<uchar> squares_of(const FoundBoard& found, double square, const cv::Size& size) {
  std::vector<cv::Point2d> from, to;
  for (Eigen::Index i = 0; i < found.board.cols(); ++i) {
    from.emplace_back(found.board(0, i), found.board(1, i));
    to.emplace_back(found.corners(0, i), found.corners(1, i));
  }
  constexpr double kAround = 0.9;  // of the outer squares; the distortion of the lens is not known
  const Eigen::Vector2d low = found.board.rowwise().minCoeff().array() - kAround * square;
  const Eigen::Vector2d high = found.board.rowwise().maxCoeff().array() + kAround * square;
  std::vector<cv::Point2d> outline{
      {low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}};
  cv::perspectiveTransform(outline, outline, cv::findHomography(from, to));
  std::vector<cv::Point> polygon;
  for (const cv::Point2d& corner : outline) polygon.emplace_back(corner);
  cv::Mat_<uchar> mask(size, 0);
  cv::fillConvexPoly(mask, polygon, cv::Scalar(255));
  return mask;
}

/// Returns true if the panel lights all of the window around a corner. At the edge of the light,
/// the corner would be pulled towards it.
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

int marker_count(const Board& board) { return (board.columns + 1) * (board.rows + 1) / 2; }

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
  const auto found = find_chessboard(gray, cv::Mat_<float>(gray), board);
  return found ? std::optional(found->corners) : std::nullopt;
}

RigView view_from_gray_code(const std::vector<cv::Mat>& images, const Board& printed,
                            const ImageSize& projector, const BoardViewOptions& options) {
  check_board(printed);
  const cv::Mat_<cv::Vec2f> places =
      decode_gray_code(images, projector, {.min_contrast = options.min_contrast});
  RigView view;
  const auto found =
      find_printed_board(as_gray8(images[images.size() - 2]), mean_image(images), printed);
  if (!found) return view;
  view.board = found->board;
  view.camera = found->corners;
  const auto grid = find_lit_grid(images, places, squares_of(*found, printed.square, places.size()),
                                  found->blur, projector);
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
  check_board(printed);
  const cv::Mat gray = as_gray8(board);
  const auto corners = find_printed_board(gray, cv::Mat_<float>(gray), printed);
  const auto lit = find_board(projected, shown);
  RigView view;
  if (corners) {
    view.board = corners->board;
    view.camera = corners->corners;
  }
  if (lit) {
    view.projector = projected_corners(projector, shown);
    view.lit_camera = *lit;
  }
  return view;
}

}  // namespace palpate::sensing
