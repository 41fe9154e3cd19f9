// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

/// Clouds whose surfaces are known, and helpers that tests of clouds share.
namespace palpate::geometry::test {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Points spread over a box.
inline Matrix3Xd random_cloud(int count, unsigned seed, const Vector3d& size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Matrix3Xd points(3, count);
  for (auto point : points.colwise()) point << uniform(random), uniform(random), uniform(random);
  return size.asDiagonal() * points;
}

/// Points spread evenly over a sphere (Fibonacci's lattice).
inline Matrix3Xd sphere_cloud(int count, const Vector3d& centre, double radius) {
  Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double turn = 2 * std::numbers::pi * i / std::numbers::phi;
    const double across = std::sqrt(1 - z * z);
    points.col(i) = centre + radius * Vector3d(across * std::cos(turn), across * std::sin(turn), z);
  }
  return points;
}

/// Points at random places on the side of a cylinder.
inline Matrix3Xd cylinder_cloud(int count, const Vector3d& middle, const Vector3d& axis,
                                double radius, double length, unsigned seed) {
  const Matrix3Xd places = random_cloud(count, seed, {2 * std::numbers::pi, length, 0});
  const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    points.col(i) = middle + (places(1, i) - length / 2) * axis +
                    radius * (std::cos(places(0, i)) * u + std::sin(places(0, i)) * v);
  }
  return points;
}

inline Matrix3Xd joined_points(const Matrix3Xd& a, const Matrix3Xd& b) {
  Matrix3Xd both(3, a.cols() + b.cols());
  both << a, b;
  return both;
}

/// Adds noise of a normal distribution to each coordinate.
inline Matrix3Xd with_noise(Matrix3Xd points, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (double& x : points.reshaped()) x += normal(random);
  return points;
}

inline Isometry3d some_motion() {
  return Eigen::Translation3d(-310.2, 47.3, 1200.9) *
         Eigen::AngleAxisd(0.8, Vector3d(1, -2, 3).normalized());
}

/// Points in another order: column i is `points.col(order[i])`.
struct Shuffled {
  std::vector<int> order;
  Matrix3Xd points;
};
inline Shuffled shuffled(const Matrix3Xd& points, unsigned seed) {
  Shuffled result{.order = std::vector<int>(static_cast<std::size_t>(points.cols())), .points = {}};
  std::iota(result.order.begin(), result.order.end(), 0);
  std::shuffle(result.order.begin(), result.order.end(), std::mt19937(seed));
  result.points = points(Eigen::all, result.order);
  return result;
}

/// Indices into shuffled points as indices into the points before, ascending.
inline std::vector<int> in_first_order(const Shuffled& shuffled, const std::vector<int>& indices) {
  std::vector<int> first;
  for (const int i : indices) first.push_back(shuffled.order[static_cast<std::size_t>(i)]);
  std::sort(first.begin(), first.end());
  return first;
}

/// Sorted distances of a point from all points, its own 0 among them.
inline std::vector<double> sorted_distances(const Matrix3Xd& points, const Vector3d& from) {
  std::vector<double> distances;
  for (const auto& point : points.colwise()) distances.push_back((point - from).norm());
  std::sort(distances.begin(), distances.end());
  return distances;
}

}  // namespace palpate::geometry::test
