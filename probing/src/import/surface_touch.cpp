// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/surface_touch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::probing {
namespace {

struct ZeroOfLine {
  double place = 0;     // [mm] at zero force
  double variance = 0;  // [mm^2] of it
  double residual = 0;  // [mm^2] mean square
};

/// By a line of the distances over force^exponent.
ZeroOfLine zero_of_line(std::span<const double> ways, std::span<const double> forces,
                        double exponent) {
  const auto count = static_cast<double>(ways.size());
  double x_mean = 0, y_mean = 0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    x_mean += std::pow(forces[i], exponent) / count;
    y_mean += ways[i] / count;
  }
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double x = std::pow(forces[i], exponent) - x_mean;
    xx += x * x;
    xy += x * (ways[i] - y_mean);
  }
  const double slope = xx > 0 ? xy / xx : 0;
  ZeroOfLine line{y_mean - slope * x_mean, 0, 0};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double error = ways[i] - line.place - slope * std::pow(forces[i], exponent);
    line.residual += error * error / count;
  }
  const double noise = line.residual * count / (count - 2);
  line.variance = xx > 0 ? noise * (1 / count + x_mean * x_mean / xx) : 0;
  return line;
}

struct ZeroOfPress {
  double place = 0;     // [mm] at zero force
  double variance = 0;  // [mm^2] of it
};

/// By lines over the force to several powers, weighted by how well they fit.
ZeroOfPress zero_of_press(std::span<const double> ways, std::span<const double> forces) {
  constexpr std::array<double, 5> kExponents = {2.0 / 3, 3.0 / 4, 5.0 / 6, 11.0 / 12, 1};
  // Residuals of one model are alike from moment to moment: many moments are not more informative.
  constexpr double kMostIndependent = 12;
  constexpr double kRounding = 1e-6;  // of the range: a smaller residual means nothing
  const double independent = std::min(static_cast<double>(ways.size()), kMostIndependent);
  const double range = std::abs(ways.back() - ways.front());
  std::array<ZeroOfLine, kExponents.size()> lines;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    lines[k] = zero_of_line(ways, forces, kExponents[k]);
    lines[k].residual += std::pow(kRounding * range, 2);
    least = std::min(least, lines[k].residual);
  }
  double sum = 0, mean = 0, square = 0;
  for (const ZeroOfLine& line : lines) {
    const double weight = least > 0 ? std::pow(least / line.residual, independent / 2) : 1;
    sum += weight;
    mean += weight * line.place;
    square += weight * (line.variance + line.place * line.place);
  }
  mean /= sum;
  return {mean, std::max(0.0, square / sum - mean * mean)};
}

}  // namespace

std::optional<TouchDepth> touch_depth(std::span<const Eigen::Vector3d> tips,
                                      std::span<const double> forces, const Eigen::Vector3d& touch,
                                      double threshold) {
  constexpr std::size_t kLeastMoments = 6;
  constexpr double kLeastRise = 2;  // relative to the threshold
  if (tips.size() < kLeastMoments || tips.size() != forces.size()) return std::nullopt;
  const double highest = *std::max_element(forces.begin(), forces.end());
  const double range = (tips.back() - touch).norm();
  if (!(highest >= kLeastRise * threshold) || !(range > 0)) return std::nullopt;
  TouchDepth found;
  found.along = (tips.back() - touch) / range;
  std::vector<double> ways;
  ways.reserve(tips.size());
  for (const Eigen::Vector3d& tip : tips) ways.push_back((tip - touch).dot(found.along));
  const ZeroOfPress zero = zero_of_press(ways, forces);
  // An object that is no such power shows it as another place by the first half of the moments.
  const std::size_t half = std::max(kLeastMoments / 2, ways.size() / 2);
  const ZeroOfPress early = zero_of_press(std::span(ways).first(half), forces.first(half));
  found.depth = -zero.place;
  found.deviation = std::hypot(std::sqrt(zero.variance), early.place - zero.place);
  if (!(found.depth > 0) || !(found.depth < range)) return std::nullopt;
  return found;
}

}  // namespace palpate::probing
