// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/corner_fit.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

namespace palpate::sensing {
namespace {

/// x y of the corner, angles of the two normals, log s, c, a, g, curvatures of the two edges.
constexpr int kUnknowns = 11;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// A soft step across a curve through the corner, whose distance is q - k s^2 with q across and s
/// along the line that touches it there.
struct Step {
  double value = 0;  ///< in [-1, 1]
  double by_distance = 0;
  Eigen::Vector2d by_place{0, 0};  ///< of the distance, by the pixel's place
  double by_angle = 0;             ///< of the distance
  double by_curvature = 0;         ///< of the distance
  double distance = 0;             ///< px
};
Step step_at(double dx, double dy, double angle, double curvature, double blur) {
  const Eigen::Vector2d n(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d t(-n.y(), n.x());
  const double across = n.x() * dx + n.y() * dy;
  const double along = t.x() * dx + t.y() * dy;
  Step step;
  step.distance = across - curvature * along * along;
  step.by_place = n - 2 * curvature * along * t;
  step.by_angle = along + 2 * curvature * along * across;
  step.by_curvature = -along * along;
  const double ratio = step.distance / blur;
  step.value = std::erf(ratio);
  step.by_distance = 2 / std::sqrt(std::numbers::pi) * std::exp(-ratio * ratio) / blur;
  return step;
}

/// Value and derivatives at a pixel that lies at (x, y) from the guess.
double model_at(double x, double y, const Unknowns& p, Unknowns& slope) {
  const double dx = x - p[0];
  const double dy = y - p[1];
  const double blur = std::exp(p[4]);
  const Step first = step_at(dx, dy, p[2], p[9], blur);
  const Step second = step_at(dx, dy, p[3], p[10], blur);
  const double light = 1 + p[7] * x + p[8] * y;
  const double saddle = first.value * second.value;
  const double board = p[5] + p[6] * saddle;
  const double by_first = light * p[6] * first.by_distance * second.value;
  const double by_second = light * p[6] * second.by_distance * first.value;
  slope << -by_first * first.by_place - by_second * second.by_place, by_first * first.by_angle,
      by_second * second.by_angle, -by_first * first.distance - by_second * second.distance, light,
      light * saddle, board * x, board * y, by_first * first.by_curvature,
      by_second * second.by_curvature;
  return light * board;
}

/// Start of the fit: the image's levels are those beside the edges.
Unknowns start_of(const cv::Mat_<float>& image, const CornerGuess& guess) {
  constexpr double kBlur = 1.4;  // px
  const auto level = [&](const Eigen::Vector2d& towards) {
    const Eigen::Vector2d at = guess.place + 0.6 * guess.radius * towards.normalized();
    return static_cast<double>(
        image(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x()))));
  };
  const Eigen::Vector2d u = guess.edges[0].normalized();
  const Eigen::Vector2d v = guess.edges[1].normalized();
  const double between = (level(u + v) + level(-u - v)) / 2;
  const double beside = (level(u - v) + level(v - u)) / 2;
  const auto normal = [](const Eigen::Vector2d& edge) { return std::atan2(edge.x(), -edge.y()); };
  Unknowns p;
  p << 0, 0, normal(u), normal(v), std::log(kBlur), (between + beside) / 2, 0, 0, 0, 0, 0;
  // Sign of the product of both distances in the direction u + v.
  const Eigen::Vector2d towards = u + v;
  const double sign = (std::cos(p[2]) * towards.x() + std::sin(p[2]) * towards.y()) *
                      (std::cos(p[3]) * towards.x() + std::sin(p[3]) * towards.y());
  p[6] = (sign > 0 ? 1 : -1) * (between - beside) / 2;
  return p;
}

/// The blurred product of light L and board B is L(x) B(x + v grad L / L) for a blur of variance v,
/// to first order: the image of the corner is moved by that much against the light's gradient.
CornerFit fit_of(const Eigen::Vector2d& guess, const Unknowns& p) {
  const double blur = std::exp(p[4]) / std::numbers::sqrt2;
  const Eigen::Vector2d gradient = p.segment<2>(7);
  return {guess + p.head<2>() + blur * blur / (1 + gradient.dot(p.head<2>())) * gradient, blur};
}

}  // namespace

std::optional<CornerFit> fit_corner(const cv::Mat_<float>& image, const CornerGuess& guess) {
  constexpr int kMostSteps = 30;
  constexpr double kLastStep = 1e-5;      // px, far below a corner's noise
  constexpr double kFarthest = 0.3;       // px from the guess: another minimum
  constexpr double kLeastContrast = 0.1;  // of the squares, |a| / c
  const int reach = static_cast<int>(guess.radius);
  const auto u = static_cast<int>(std::lround(guess.place.x()));
  const auto v = static_cast<int>(std::lround(guess.place.y()));
  if (u < reach || v < reach || u + reach >= image.cols || v + reach >= image.rows)
    return std::nullopt;
  // Along short edges, a bend by the lens is far below the noise, and looks like a shift.
  constexpr double kLeastBent = 10;  // px
  const bool straight = guess.radius < kLeastBent;
  Unknowns p = start_of(image, guess);
  for (int i = 0; i < kMostSteps; ++i) {
    Normal normal = Normal::Zero();
    Unknowns right = Unknowns::Zero();
    Unknowns slope;
    for (int row = v - reach; row <= v + reach; ++row) {
      for (int column = u - reach; column <= u + reach; ++column) {
        const double x = column - guess.place.x();
        const double y = row - guess.place.y();
        if (x * x + y * y > guess.radius * guess.radius) continue;
        const double miss = static_cast<double>(image(row, column)) - model_at(x, y, p, slope);
        normal.selfadjointView<Eigen::Lower>().rankUpdate(slope);
        right += miss * slope;
      }
    }
    if (straight) {
      normal.bottomRows<2>().setZero();
      normal.bottomRightCorner<2, 2>().setIdentity();
      right.tail<2>().setZero();
    }
    // Hundreds of pixels determine eleven numbers well.
    const Unknowns step = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    p += step;
    if (!p.allFinite() || !(p.head<2>().norm() <= kFarthest)) return std::nullopt;
    if (step.head<2>().norm() > kLastStep) continue;
    if (!(std::abs(p[6]) >= kLeastContrast * p[5])) return std::nullopt;
    return fit_of(guess.place, p);
  }
  return std::nullopt;
}

}  // namespace palpate::sensing
