// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lit_grid.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include "image/image_plane.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// Cells are squares of this side [px]: small enough that a lens hardly bends within one.
constexpr int kGridCell = 12;
/// A cell needs as many crossings of each axis.
constexpr std::size_t kLeastBorders = 20;
/// A pixel counts if the light within kReach of it differs by less than this share.
constexpr double kLeastEvenness = 0.7;
constexpr int kReach = 3;  // px: the reach of blur
/// A crossing counts if image and inverse change by this share of the light from pixel to pixel.
constexpr float kLeastStep = 0.1F;

/// A crossing of one axis' code: a camera pixel, the panel's border there, and a weight.
struct BorderPlace {
  Eigen::Vector2d camera;
  double border = 0;  ///< px
  double weight = 0;  ///< inverse variance, in any unit
  double residual = 0;
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();  ///< relative gradient of the light [1/px]
};

/// Pixels of the board whose light is even and not saturated.
cv::Mat_<uchar> even_pixels(const std::vector<cv::Mat>& images, const cv::Mat_<uchar>& on_board,
                            cv::Mat_<float>& light) {
  const cv::Mat& white = images[images.size() - 2];
  cv::subtract(white, images.back(), light, cv::noArray(), CV_32F);
  cv::Mat_<float> smooth;
  cv::blur(light, smooth, {3, 3});
  const cv::Mat around = cv::Mat::ones(2 * kReach + 1, 2 * kReach + 1, CV_8U);
  cv::Mat_<float> least, most;
  cv::erode(smooth, least, around);
  cv::dilate(smooth, most, around);
  cv::Mat_<uchar> even;
  cv::Mat((least > kLeastEvenness * most) & (white < full_scale(white)) & (on_board != 0))
      .copyTo(even);
  return even;
}

/// Homography of the codes, robust against wrong ones.
std::optional<Eigen::Matrix3d> fit_homography(const cv::Mat_<cv::Vec2f>& places,
                                              const cv::Mat_<uchar>& even) {
  constexpr int kStride = 3;        // px: enough pixels
  constexpr double kTolerance = 4;  // px: distortion of both lenses over a board
  constexpr std::size_t kLeast = 100;
  std::vector<cv::Point2f> from, to;
  for (int row = 0; row < places.rows; row += kStride) {
    for (int column = 0; column < places.cols; column += kStride) {
      const cv::Vec2f& place = places(row, column);
      if (even(row, column) == 0 || std::isnan(place[0])) continue;
      from.emplace_back(static_cast<float>(column), static_cast<float>(row));
      to.emplace_back(place[0], place[1]);
    }
  }
  if (from.size() < kLeast) return std::nullopt;
  const cv::Mat found = cv::findHomography(from, to, cv::RANSAC, kTolerance);
  if (found.empty()) return std::nullopt;
  Eigen::Matrix3d homography;
  cv::cv2eigen(found, homography);
  return homography;
}

/// Border of the code's bit nearest to a place on the panel [px]. In a reflected code, bit b
/// changes every 2^(b + 1) pixels, first after 2^b of them.
double nearest_border(int bit, double place) {
  const double step = std::ldexp(1.0, bit + 1);
  const double first = std::ldexp(1.0, bit) - 0.5;
  return first + step * std::round((place - first) / step);
}

/// The crossings of one bit between pixels and their neighbours at `next`.
void collect(const cv::Mat_<float>& difference, const cv::Mat_<float>& light,
             const cv::Mat_<cv::Vec2f>& places, const cv::Mat_<uchar>& even, int bit, int axis,
             cv::Point next, std::vector<BorderPlace>& crossings) {
  for (int row = 0; row + next.y < difference.rows; ++row) {
    for (int column = 0; column + next.x < difference.cols; ++column) {
      const float here = difference(row, column);
      const float there = difference(row + next.y, column + next.x);
      if ((here > 0) == (there > 0) || even(row, column) == 0 ||
          even(row + next.y, column + next.x) == 0)
        continue;
      const float step = std::abs(there - here);
      if (!(step >= kLeastStep * light(row, column))) continue;
      const double place = 0.5 * static_cast<double>(places(row, column)[axis] +
                                                     places(row + next.y, column + next.x)[axis]);
      const double border = nearest_border(bit, place);
      if (!(std::abs(border - place) <= 1)) continue;  // NaN too
      const double part = static_cast<double>(here / (here - there));
      crossings.push_back({{column + part * next.x, row + part * next.y},
                           border,
                           static_cast<double>(step) * static_cast<double>(step)});
    }
  }
}

/// Relative gradient of the light at each crossing.
void set_rises(const cv::Mat_<float>& light, std::vector<BorderPlace>& crossings) {
  cv::Mat_<float> smooth;
  cv::blur(light, smooth, {3, 3});
  for (BorderPlace& crossing : crossings) {
    const auto column = static_cast<int>(std::lround(crossing.camera.x()));
    const auto row = static_cast<int>(std::lround(crossing.camera.y()));
    if (column < kReach || row < kReach || column + kReach >= light.cols ||
        row + kReach >= light.rows)
      continue;
    const Eigen::Vector2f rise(smooth(row, column + kReach) - smooth(row, column - kReach),
                               smooth(row + kReach, column) - smooth(row - kReach, column));
    crossing.rise = (rise / (2 * kReach * smooth(row, column))).cast<double>();
  }
}

using Cubic = Eigen::Matrix<double, 10, 1>;
Cubic cubic_terms(const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y();
  Cubic terms;
  terms << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
  return terms;
}

/// The smooth map of one axis.
struct SmoothMap {
  Eigen::Matrix3d homography;
  int axis = 0;
  Eigen::Vector2d middle;
  double scale = 1;
  Cubic correction = Cubic::Zero();

  [[nodiscard]] double operator()(const Eigen::Vector2d& camera) const {
    const Eigen::Vector2d p = (homography * camera.homogeneous()).hnormalized();
    return p[axis] + correction.dot(cubic_terms((camera - middle) / scale));
  }
};

/// Fits the correction by least squares, and again without outliers.
void fit_correction(const std::vector<BorderPlace>& crossings, SmoothMap& map) {
  constexpr std::array<double, 3> kLargest{4, 1, 0.5};  // px: a wrong border is a pixel off or more
  for (const double largest : kLargest) {
    Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
    Cubic right = Cubic::Zero();
    for (const BorderPlace& crossing : crossings) {
      const double miss = crossing.border - map(crossing.camera);
      if (!(std::abs(miss) <= largest)) continue;
      const Cubic terms = cubic_terms((crossing.camera - map.middle) / map.scale);
      normal += crossing.weight * terms * terms.transpose();
      right += crossing.weight * miss * terms;
    }
    // Terms of numbers within [-1, 1]: the condition is mild.
    map.correction += Cubic(normal.completeOrthogonalDecomposition().solve(right));
  }
}

/// Robust mean of the crossings of a cell.
struct CellMean {
  Eigen::Vector2d camera = Eigen::Vector2d::Zero();
  double residual = 0;
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();  ///< median
};
std::optional<CellMean> mean_of(const std::vector<const BorderPlace*>& cell) {
  if (cell.size() < kLeastBorders) return std::nullopt;
  std::vector<double> values;
  values.reserve(cell.size());
  for (const BorderPlace* crossing : cell) values.push_back(crossing->residual);
  const double middle = median(values);
  for (double& value : values) value = std::abs(value - middle);
  constexpr double kCut = 5;  // times the median deviation: 3.4 standard deviations
  const double largest = kCut * median(values);
  CellMean mean;
  double sum = 0;
  for (const BorderPlace* crossing : cell) {
    if (!(std::abs(crossing->residual - middle) <= largest)) continue;
    sum += crossing->weight;
    mean.camera += crossing->weight * crossing->camera;
    mean.residual += crossing->weight * crossing->residual;
  }
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < cell.size(); ++i) values[i] = cell[i]->rise[axis];
    mean.rise[axis] = median(values);
  }
  mean.camera /= sum;
  mean.residual /= sum;
  return mean;
}

/// Means over the cells of the image, one entry per cell.
std::vector<std::optional<CellMean>> cell_means(std::vector<BorderPlace>& crossings,
                                                const SmoothMap& map, const cv::Size& size) {
  const int columns = size.width / kGridCell + 1;
  const int rows = size.height / kGridCell + 1;
  std::vector<std::vector<const BorderPlace*>> cells(static_cast<std::size_t>(rows * columns));
  for (BorderPlace& crossing : crossings) {
    crossing.residual = crossing.border - map(crossing.camera);
    if (!(std::abs(crossing.residual) <= 1)) continue;  // px: a wrong code
    const int cell = static_cast<int>(crossing.camera.y()) / kGridCell * columns +
                     static_cast<int>(crossing.camera.x()) / kGridCell;
    cells[static_cast<std::size_t>(cell)].push_back(&crossing);
  }
  std::vector<std::optional<CellMean>> means;
  means.reserve(cells.size());
  for (const auto& cell : cells) means.push_back(mean_of(cell));
  return means;
}

/// Returns true if the panel's `axis` runs along the rows of the image rather than its columns.
bool runs_along_rows(const Eigen::Matrix3d& homography, int axis, const Eigen::Vector2d& at) {
  const auto place = [&](const Eigen::Vector2d& p) {
    return (homography * p.homogeneous()).hnormalized()[axis];
  };
  return std::abs(place(at + Eigen::Vector2d::UnitX()) - place(at)) >=
         std::abs(place(at + Eigen::Vector2d::UnitY()) - place(at));
}

}  // namespace

std::optional<LitGrid> find_lit_grid(const std::vector<cv::Mat>& images,
                                     const cv::Mat_<cv::Vec2f>& places,
                                     const cv::Mat_<uchar>& on_board, double blur,
                                     const ImageSize& panel) {
  cv::Mat_<float> light;
  const cv::Mat_<uchar> even = even_pixels(images, on_board, light);
  const auto homography = fit_homography(places, even);
  if (!homography) return std::nullopt;
  const cv::Rect area = cv::boundingRect(even);
  const Eigen::Vector2d middle(area.x + area.width / 2.0, area.y + area.height / 2.0);
  const double scale = std::max(area.width, area.height) / 2.0;
  std::array<SmoothMap, 2> maps;
  std::array<std::vector<std::optional<CellMean>>, 2> means;
  std::size_t image = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const bool along_rows = runs_along_rows(*homography, axis, middle);
    const int bits =
        std::bit_width(static_cast<unsigned>((axis == 0 ? panel.width : panel.height) - 1));
    std::vector<BorderPlace> crossings;
    for (int bit = bits - 1; bit >= 0; --bit, image += 2) {
      cv::Mat_<float> difference;
      cv::subtract(images[image], images[image + 1], difference, cv::noArray(), CV_32F);
      collect(difference, light, places, even, bit, axis,
              along_rows ? cv::Point(1, 0) : cv::Point(0, 1), crossings);
    }
    set_rises(light, crossings);
    maps[a] = {*homography, axis, middle, scale};
    if (crossings.size() < kLeastBorders) return std::nullopt;
    fit_correction(crossings, maps[a]);
    means[a] = cell_means(crossings, maps[a], even.size());
  }
  std::vector<Eigen::Vector2d> camera, projector;
  for (std::size_t cell = 0; cell < means[0].size(); ++cell) {
    const auto& x = means[0][cell];
    const auto& y = means[1][cell];
    if (!x || !y) continue;
    const Eigen::Vector2d at = (x->camera + y->camera) / 2;
    // See `fit_corner`.
    camera.push_back(at + blur * blur * (x->rise + y->rise) / 2);
    projector.emplace_back(maps[0](at) + x->residual, maps[1](at) + y->residual);
  }
  LitGrid grid{Eigen::Matrix2Xd(2, camera.size()), Eigen::Matrix2Xd(2, camera.size()), *homography};
  for (std::size_t i = 0; i < camera.size(); ++i) {
    grid.camera.col(static_cast<Eigen::Index>(i)) = camera[i];
    grid.projector.col(static_cast<Eigen::Index>(i)) = projector[i];
  }
  return grid;
}

}  // namespace palpate::sensing
