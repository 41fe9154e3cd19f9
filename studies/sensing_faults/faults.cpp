// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "faults.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace palpate::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

using Move = std::function<void(const cv::Mat& in, cv::Mat& out)>;

/// Moves the pixels of an array of floats or of truth values.
template <typename Array>
void move_array(const Move& move, int type, Array& array) {
  const cv::Mat in(static_cast<int>(array.rows()), static_cast<int>(array.cols()), type,
                   array.data());
  cv::Mat out;
  move(in, out);
  out.copyTo(in);
}

/// Moves the pixels of frame and truth alike.
Fault moved(const char* name, const Move& move) {
  return {name, [move](Scene& scene) {
            for (View& view : scene.views) {
              cv::Mat out;
              move(view.frame, out);
              view.frame = out;
              move_array(move, CV_32F, view.z);
              move_array(move, CV_8U, view.counted);
            }
          }};
}

/// An affine map; the frame is interpolated, the truth is not.
void warp(const cv::Mat& in, const cv::Matx23d& map, cv::Mat& out) {
  const int how = in.channels() == 3 ? cv::INTER_LINEAR : cv::INTER_NEAREST;
  const cv::Scalar beyond = in.depth() == CV_32F ? cv::Scalar::all(std::nan("")) : cv::Scalar();
  cv::warpAffine(in, out, map, in.size(), how, cv::BORDER_CONSTANT, beyond);
}

Fault warped(const char* name, const cv::Matx23d& map) {
  return moved(name, [map](const cv::Mat& in, cv::Mat& out) { warp(in, map, out); });
}

/// From the middle row on, the frame is shifted, as by a transfer that loses data.
Fault torn(const char* name, double columns, double rows) {
  return moved(name, [columns, rows](const cv::Mat& in, cv::Mat& out) {
    warp(in, {1, 0, columns, 0, 1, rows}, out);
    const cv::Range upper(0, in.rows / 2);
    in.rowRange(upper).copyTo(out.rowRange(upper));
  });
}

Fault recolored(const char* name, const Move& recolor) {
  return {name, [recolor](Scene& scene) {
            for (View& view : scene.views) {
              cv::Mat out;
              recolor(view.frame, out);
              view.frame = out;
            }
          }};
}

Fault permuted(const char* name, const std::vector<int>& from) {
  return recolored(name, [from](const cv::Mat& in, cv::Mat& out) {
    out.create(in.size(), in.type());
    const std::vector<int> pairs = {from[0], 0, from[1], 1, from[2], 2};
    cv::mixChannels({in}, {out}, pairs);
  });
}

/// Values as by a power of the light, relative to full scale.
cv::Mat power(const cv::Mat& in, double exponent) {
  const double full = in.depth() == CV_8U ? 255 : 65535;
  cv::Mat light, out;
  in.convertTo(light, CV_32F, 1 / full);
  cv::max(light, 0, light);
  cv::pow(light, exponent, light);
  light.convertTo(out, in.type(), full);
  return out;
}

Fault another_rig(const char* name, const std::function<void(sensing::Rig&)>& change) {
  return {name, [change](Scene& scene) { change(scene.rig); }};
}

void turn(sensing::Rig& rig, const Eigen::Vector3d& axis, double degrees) {
  // About the projector's centre.
  const Eigen::Isometry3d by(Eigen::AngleAxisd(degrees * kDegree, axis));
  rig.T_projector_camera = by * rig.T_projector_camera;
}

Fault another_pattern(const char* name, const std::function<void(sensing::Pattern&)>& change) {
  return {name, [change](Scene& scene) { change(scene.pattern); }};
}

Fault other_colors(const char* name, const std::function<void(sensing::TrainedColors&)>& change) {
  return {name, [change](Scene& scene) { change(scene.colors); }};
}

void swap_names(sensing::TrainedColors& colors, const char* a, const char* b) {
  for (sensing::TrainedColor& color : colors.colors) {
    if (color.name == a) {
      color.name = b;
    } else if (color.name == b) {
      color.name = a;
    }
  }
}

/// Another sequence with the same colours, in which every ordered pair appears once as well: four
/// of six change their roles, in a way that no exchange of channels does.
void change_roles(sensing::Pattern& pattern) {
  constexpr int kOther[] = {1, 0, 4, 3, 2, 5};
  for (int& stripe : pattern.stripes) stripe = stripe < 6 ? kOther[stripe] : stripe;
}

}  // namespace

std::vector<Fault> faults_of_frames() {
  const auto flipped = [](const char* name, int code) {
    return moved(name, [code](const cv::Mat& in, cv::Mat& out) { cv::flip(in, out, code); });
  };
  const auto rows = [](const char* name, const std::function<int(int row, int rows)>& from) {
    return moved(name, [from](const cv::Mat& in, cv::Mat& out) {
      out.create(in.size(), in.type());
      for (int row = 0; row < in.rows; ++row) in.row(from(row, in.rows)).copyTo(out.row(row));
    });
  };
  return {
      permuted("red and blue swapped", {2, 1, 0}),
      permuted("red and green swapped", {0, 2, 1}),
      permuted("green and blue swapped", {1, 0, 2}),
      flipped("rotated by 180 degrees", -1),
      flipped("mirrored", 1),
      flipped("flipped", 0),
      rows("fields swapped", [](int row, int all) { return std::min(row ^ 1, all - 1); }),
      rows("rows doubled", [](int row, int) { return row & ~1; }),
      rows("fields one after the other",
           [](int row, int all) { return row < all / 2 ? 2 * row : 2 * (row - all / 2) + 1; }),
      warped("scaled by 1.05", {1.05, 0, -16, 0, 1.05, -12}),
      warped("shifted by 10 px", {1, 0, 10, 0, 1, 0}),
      warped("shifted by 10 rows", {1, 0, 0, 0, 1, 10}),
      torn("lower half shifted by 20 px", 20, 0),
      torn("lower half shifted by 7 rows", 0, 7),
      recolored("negative", [](const cv::Mat& in, cv::Mat& out) { cv::bitwise_not(in, out); }),
      recolored("gamma 2.2", [](const cv::Mat& in, cv::Mat& out) { out = power(in, 1 / 2.2); }),
  };
}

std::vector<Fault> faults_of_files() {
  using sensing::Pattern;
  using sensing::Rig;
  return {
      another_pattern("stripes reversed",
                      [](Pattern& p) { std::reverse(p.stripes.begin(), p.stripes.end()); }),
      another_pattern("stripes shifted by one",
                      [](Pattern& p) {
                        // All ordered pairs of neighbours stay different: first and last are equal.
                        p.stripes.erase(p.stripes.begin());
                        p.stripes.push_back(p.stripes.front());
                      }),
      another_pattern("another sequence of stripes", change_roles),
      another_pattern("period 3 % longer", [](Pattern& p) { p.period *= 1.03; }),
      another_pattern("phase off by pi / 2", [](Pattern& p) { p.phase += std::numbers::pi / 2; }),
      another_pattern("sinusoid along the other axis",
                      [](Pattern& p) {
                        p.axis = p.axis == sensing::Axis::x ? sensing::Axis::y : sensing::Axis::x;
                      }),
      another_pattern("pattern for a panel of 1280 columns",
                      [](Pattern& p) {
                        p.period *= 1.25;
                        for (double& edge : p.stripe_edges) edge = 1.25 * (edge + 0.5) - 0.5;
                      }),
      another_rig("projector's focal length 2 % off",
                  [](Rig& r) {
                    r.projector.fx *= 1.02;
                    r.projector.fy *= 1.02;
                  }),
      another_rig("projector's principal point off by 15 columns",
                  [](Rig& r) { r.projector.cx += 15; }),
      another_rig("projector's principal point off by 15 rows",
                  [](Rig& r) { r.projector.cy += 15; }),
      another_rig("baseline 10 mm off along x",
                  [](Rig& r) { r.T_projector_camera.translation().x() += 10; }),
      another_rig("baseline 10 mm off along y",
                  [](Rig& r) { r.T_projector_camera.translation().y() += 10; }),
      another_rig("baseline 20 mm off along z",
                  [](Rig& r) { r.T_projector_camera.translation().z() += 20; }),
      another_rig("baseline 6 % longer",
                  [](Rig& r) { r.T_projector_camera.translation() *= 1.06; }),
      another_rig("pose inverted",
                  [](Rig& r) { r.T_projector_camera = r.T_projector_camera.inverse(); }),
      another_rig("camera's focal length 2 % off",
                  [](Rig& r) {
                    r.camera.fx *= 1.02;
                    r.camera.fy *= 1.02;
                  }),
      another_rig("camera's principal point off by 15 columns", [](Rig& r) { r.camera.cx += 15; }),
      another_rig("camera's principal point off by 15 rows", [](Rig& r) { r.camera.cy += 15; }),
      another_rig("projector turned by 1 degree about its axis",
                  [](Rig& r) { turn(r, Eigen::Vector3d::UnitZ(), 1); }),
      another_rig("projector tilted by 0.5 degrees",
                  [](Rig& r) { turn(r, Eigen::Vector3d::UnitX(), 0.5); }),
      another_rig("projector panned by 0.5 degrees",
                  [](Rig& r) { turn(r, Eigen::Vector3d::UnitY(), 0.5); }),
      another_rig("camera's lens distortion not as given",
                  [](Rig& r) { r.camera.distortion[0] += 0.15; }),
      another_rig("projector's lens distortion not as given",
                  [](Rig& r) { r.projector.distortion[0] += 0.1; }),
      another_rig("chromatic values of red and blue swapped",
                  [](Rig& r) { std::swap(r.red, r.blue); }),
      other_colors("trained red and blue swapped",
                   [](sensing::TrainedColors& c) {
                     swap_names(c, "R", "B");
                     swap_names(c, "Y", "C");
                   }),
      other_colors("trained hues 30 degrees off",
                   [](sensing::TrainedColors& c) {
                     for (sensing::TrainedColor& color : c.colors) {
                       color.mean = std::fmod(color.mean + 30 * kDegree, 2 * std::numbers::pi);
                     }
                   }),
  };
}

}  // namespace palpate::bench
