// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <utility>
#include <vector>

#include "calibration/found_board.h"
#include "files/storage_file.h"
#include "palpate/core/quantile.h"
#include "palpate/sensing/board_print.h"

namespace palpate::sensing {
namespace {

/// The smallest of OpenCV's dictionaries that has enough markers. The larger ones of as many bits
/// begin with the same markers, so it fits any board.
cv::Ptr<cv::aruco::Dictionary> markers_of(const Board& board) {
  constexpr std::array<int, 4> kSizes{50, 100, 250, kMostMarkers};
  const int needed = marker_count(board);
  const auto size = std::find_if(kSizes.begin(), kSizes.end(), [=](int n) { return n >= needed; });
  constexpr int kFewestBits = 4;
  return cv::aruco::getPredefinedDictionary(
      cv::aruco::DICT_4X4_50 + static_cast<int>(kSizes.size()) * (board.marker_bits - kFewestBits) +
      static_cast<int>(size - kSizes.begin()));
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_of(const Board& board) {
  return cv::aruco::CharucoBoard::create(board.columns + 1, board.rows + 1,
                                         static_cast<float>(board.square),
                                         static_cast<float>(board.marker), markers_of(board));
}

/// Steps along the board's axes at a point of it, by one square [px].
std::pair<Eigen::Vector2d, Eigen::Vector2d> edges_at(const Eigen::Matrix3d& homography,
                                                     const Eigen::Vector2d& point, double square) {
  const auto at = [&](double dx, double dy) -> Eigen::Vector2d {
    return (homography * (point + Eigen::Vector2d(dx, dy)).homogeneous()).hnormalized();
  };
  return {at(square / 2, 0) - at(-square / 2, 0), at(0, square / 2) - at(0, -square / 2)};
}

}  // namespace

std::vector<BoardPatch> board_patches(const Board& board) {
  (void)board_corners(board);  // checks the board
  std::vector<BoardPatch> patches;
  int marker = 0;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      const double x = column * board.square, y = row * board.square;
      if ((row + column) % 2 == 0) {
        patches.push_back({x, y, board.square, board.square});
        continue;
      }
      if (!(board.marker > 0)) continue;
      const auto dictionary = markers_of(board);
      const int cells = dictionary->markerSize + 2;  // with its black border
      cv::Mat_<uchar> bits;
      dictionary->drawMarker(marker++, cells, bits, 1);
      const double side = board.marker / cells, margin = (board.square - board.marker) / 2;
      for (int v = 0; v < cells; ++v) {
        for (int u = 0; u < cells; ++u) {
          if (bits(v, u) == 0)
            patches.push_back({x + margin + u * side, y + margin + v * side, side, side});
        }
      }
    }
  }
  return patches;
}

std::optional<FoundBoard> find_charuco_board(const cv::Mat& gray, const cv::Mat_<float>& fine,
                                             const Board& board) {
  const QuietOpenCv quiet;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> names, ids;
  std::vector<cv::Point2f> found;
  cv::aruco::detectMarkers(gray, markers_of(board), markers, names);
  if (names.empty()) return std::nullopt;
  cv::aruco::interpolateCornersCharuco(markers, names, gray, charuco_of(board), found, ids);
  constexpr std::size_t kLeast = 4;  // for a homography
  if (ids.size() < kLeast) return std::nullopt;
  const Eigen::Matrix2Xd all = board_corners(board);
  std::vector<cv::Point2d> on_board, seen(found.begin(), found.end());
  for (const int id : ids) on_board.emplace_back(all(0, id), all(1, id));
  constexpr double kFarthest = 0.5;  // squares from the place by the others: more than a lens bends
  std::vector<uchar> fits;
  const cv::Mat map =
      cv::findHomography(seen, on_board, cv::RANSAC, kFarthest * board.square, fits);
  if (map.empty()) return std::nullopt;  // all on one line
  Eigen::Matrix3d homography;
  cv::cv2eigen(map, homography);
  homography = homography.inverse().eval();
  // A marker's corner is the nearest point that does not belong to the board's corner.
  const double nearest = (board.square - board.marker) / 2 * std::numbers::sqrt2 / board.square;
  FoundBoard result{.board = all, .corners = all};
  std::vector<double> blurs;
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (fits[i] == 0) continue;
    const Eigen::Vector2d corner = all.col(ids[i]);
    const auto [along, down] = edges_at(homography, corner, board.square);
    const CornerGuess guess = corner_guess({seen[i].x, seen[i].y}, along, down, nearest);
    result.window = std::max(result.window, static_cast<int>(guess.radius));
    result.board.col(count) = corner;
    const CornerFit fit = refine_corner(fine, guess);
    result.corners.col(count++) = fit.place;
    blurs.push_back(fit.blur);
  }
  result.blur = median(blurs);
  result.board.conservativeResize(Eigen::NoChange, count);
  result.corners.conservativeResize(Eigen::NoChange, count);
  return result;
}

}  // namespace palpate::sensing
