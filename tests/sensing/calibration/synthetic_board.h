// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "palpate/sensing/board_print.h"
#include "palpate/sensing/board_views.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

inline constexpr ImageSize kPanel{512, 384};

/// A verging rig whose lenses bend light, camera 640 x 480 px, panel `kPanel`.
inline Rig make_board_rig() {
  Rig rig;
  rig.camera = {.width = 640, .height = 480, .fx = 801, .fy = 803, .cx = 325.3, .cy = 236.7};
  rig.camera.distortion = {-0.12, 0.08, 0.001, -0.0013};
  rig.projector = {.width = 512, .height = 384, .fx = 903, .fy = 899, .cx = 251.9, .cy = 215.3};
  rig.projector.distortion = {0.05, -0.07, -0.0008, 0.0011};
  rig.T_projector_camera.linear() = (Eigen::AngleAxisd(0.21, Eigen::Vector3d::UnitX()) *
                                     Eigen::AngleAxisd(-0.17, Eigen::Vector3d::UnitY()) *
                                     Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ()))
                                        .toRotationMatrix();
  rig.T_projector_camera.translation() = Eigen::Vector3d(90.7, 121.3, -11.9);
  return rig;
}

inline constexpr Board kPrinted{.columns = 9, .rows = 6, .square = 15.5};

/// Poses of the printed board about half a metre away, its middle near the optical axis; `tilt`
/// [rad] is their angle, each in another direction.
inline std::vector<Eigen::Isometry3d> board_poses(int count, double tilt = 0.5) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double way = 2.4 * i;  // the golden angle: evenly all around
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(
        Eigen::Vector3d(18 * std::cos(5.0 * i), 14 * std::sin(3.0 * i), 430 + 25 * (i % 4)));
    pose.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(way), std::sin(way), 0)));
    pose.translate(Eigen::Vector3d(-4 * kPrinted.square, -2.5 * kPrinted.square, 0));
    poses.push_back(pose);
  }
  return poses;
}

inline Eigen::Vector2d seen_by(const geometry::Camera& lens, const Eigen::Vector3d& point) {
  return geometry::distort(lens, point.hnormalized());
}

/// Points of a board in the camera and the projector, exactly.
inline RigView exact_view(const Rig& rig, const Eigen::Isometry3d& T_camera_board,
                          const std::string& name) {
  RigView view{.name = name, .board = board_corners(kPrinted)};
  view.camera = view.projector = view.board;
  for (Eigen::Index i = 0; i < view.board.cols(); ++i) {
    const Eigen::Vector3d corner(view.board(0, i), view.board(1, i), 0);
    view.camera.col(i) = seen_by(rig.camera, T_camera_board * corner);
    view.projector.col(i) =
        seen_by(rig.projector, rig.T_projector_camera * T_camera_board * corner);
  }
  view.lit_camera = view.camera;
  return view;
}

inline void add_noise(Eigen::Matrix2Xd& pixels, double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0, sigma);
  for (double& value : pixels.reshaped()) value += noise(random);
}

inline std::vector<RigView> make_views(const Rig& rig, const std::vector<Eigen::Isometry3d>& poses,
                                       double camera_sigma = 0, double projector_sigma = 0,
                                       unsigned seed = 1) {
  std::mt19937 random(seed);
  std::vector<RigView> views;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    views.push_back(exact_view(rig, poses[i], "view " + std::to_string(i)));
    add_noise(views.back().camera, camera_sigma, random);
    add_noise(views.back().projector, projector_sigma, random);
  }
  return views;
}

/// +1 and -1 in turns from one whole number to the next, over an edge `soft` wide on both sides.
inline double soft_square_wave(double x, double soft) {
  const double nearest = std::round(x);
  const double side = std::clamp((x - nearest) / soft, -1.0, 1.0);
  return std::fmod(std::abs(nearest), 2) == 0 ? side : -side;
}

/// The light of a panel between its pixels, 0 beside it.
inline double shine(const cv::Mat& shown, const Eigen::Vector2d& at) {
  const Eigen::Vector2d low = at.array().floor();
  const Eigen::Vector2d part = at - low;
  double light = 0;
  for (const int dx : {0, 1}) {
    for (const int dy : {0, 1}) {
      const int x = static_cast<int>(low.x()) + dx;
      const int y = static_cast<int>(low.y()) + dy;
      if (x < 0 || y < 0 || x >= shown.cols || y >= shown.rows) continue;
      light += (dx != 0 ? part.x() : 1 - part.x()) * (dy != 0 ? part.y() : 1 - part.y()) *
               shown.at<uchar>(y, x);
    }
  }
  return light;
}

/// Reflectance of a print at a place of the board [mm].
using Print = std::function<double(const Eigen::Vector2d& point)>;

/// `kPrinted` on a white sheet, with edges blurred on both sides by this share of a square.
inline Print chessboard_print(double soft) {
  return [soft](const Eigen::Vector2d& point) {
    const Eigen::Vector2d square = point / kPrinted.square;
    const bool on_board = square.x() > -1 && square.y() > -1 && square.x() < kPrinted.columns &&
                          square.y() < kPrinted.rows;
    const double wave =
        on_board ? soft_square_wave(square.x(), soft) * soft_square_wave(square.y(), soft) : 1;
    return 0.9 - 0.375 * (1 - wave);
  };
}

/// Draws a board as `write_board_print` does, on white paper, `per_mm` pixels a millimetre.
inline cv::Mat_<uchar> draw_board(const Board& board, double per_mm) {
  const auto px = [&](double mm) { return static_cast<int>(std::lround(mm * per_mm)); };
  cv::Mat_<uchar> image(px((board.rows + 3) * board.square), px((board.columns + 3) * board.square),
                        230);
  for (const BoardPatch& patch : board_patches(board)) {
    const int x = px(patch.x + board.square);
    const int y = px(patch.y + board.square);
    image(cv::Rect(x, y, px(patch.x + board.square + patch.width) - x,
                   px(patch.y + board.square + patch.height) - y)) = 38;
  }
  return image;
}

/// Place in that drawing [px] of a point of the board [mm] from its first inner corner.
inline Eigen::Vector2d drawn_at(const Board& board, const Eigen::Vector2d& point, double per_mm) {
  return ((point.array() + 2 * board.square) * per_mm - 0.5).matrix();
}

/// A board as it is printed, blurred by a third of a pixel of the camera.
inline Print print_of(const Board& board) {
  constexpr double kPerMm = 12;  // px
  cv::Mat_<uchar> fine = draw_board(board, kPerMm);
  cv::GaussianBlur(fine, fine, {0, 0}, 0.2 * kPerMm);
  return [fine, board](const Eigen::Vector2d& point) {
    const Eigen::Vector2d at = drawn_at(board, point, kPerMm);
    if (at.x() < 0 || at.y() < 0 || at.x() > fine.cols - 1 || at.y() > fine.rows - 1) return 0.9;
    return fine(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x()))) /
           255.0;
  };
}

/// Photographs of a printed board, by default `kPrinted`, by the camera under each image that the
/// projector shows: edges blurred over about a pixel, room light, and noise of one grey level. A
/// pixel has the mean of the print over 3 x 3 places: one place alone would displace its edges.
inline std::vector<cv::Mat> photograph(const Rig& rig, const Eigen::Isometry3d& T_camera_board,
                                       const std::vector<cv::Mat>& shown, unsigned seed = 1,
                                       Print print = {}) {
  const geometry::Camera& camera = rig.camera;
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  const Eigen::Vector3d eye = T_board_camera.translation();
  const Eigen::Isometry3d T_projector_board = rig.T_projector_camera * T_camera_board;
  if (!print) print = chessboard_print(0.8 * eye.norm() / (camera.fx * kPrinted.square));
  std::vector<cv::Mat> photos;
  for (std::size_t i = 0; i < shown.size(); ++i)
    photos.emplace_back(camera.height, camera.width, CV_32F, cv::Scalar(0));
  const auto point_at = [&](int u, int v) -> Eigen::Vector3d {
    const Eigen::Vector3d ray =
        T_board_camera.linear() * geometry::undistort(camera, Eigen::Vector2d(u, v)).homogeneous();
    return eye - eye.z() / ray.z() * ray;
  };
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d point = point_at(u, v);
      const Eigen::Vector2d right = (point_at(u + 1, v) - point).head<2>();
      const Eigen::Vector2d down = (point_at(u, v + 1) - point).head<2>();
      double albedo = 0;
      for (const int i : {-1, 0, 1}) {
        for (const int j : {-1, 0, 1})
          albedo += print(point.head<2>() + (i * right + j * down) / 3);
      }
      albedo /= 9;
      const Eigen::Vector2d lamp = seen_by(rig.projector, T_projector_board * point);
      for (std::size_t i = 0; i < shown.size(); ++i)
        photos[i].at<float>(v, u) = static_cast<float>(albedo * (20 + 0.8 * shine(shown[i], lamp)));
    }
  }
  cv::RNG random(seed);
  for (cv::Mat& photo : photos) {
    cv::Mat noise(photo.size(), CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    photo += noise;
    photo.convertTo(photo, CV_8U);
  }
  return photos;
}

}  // namespace palpate::sensing
