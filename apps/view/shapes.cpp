// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace palpate::view {
namespace {

constexpr int kSides = 32;
constexpr float kSlope = std::numbers::sqrt2_v<float> / 2;
constexpr float kPi = std::numbers::pi_v<float>;

/// Of a profile: radius and height, and the same of the normal.
struct ProfilePoint {
  float radius, height, outwards, upwards;
};

/// A part of a circle about (radius, 0), in `steps` lines.
std::vector<ProfilePoint> circle(float radius, float thickness, int steps, float from, float to) {
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= steps; ++i) {
    const float angle = from + (to - from) * static_cast<float>(i) / static_cast<float>(steps);
    const float c = std::cos(angle), s = std::sin(angle);
    profile.push_back({radius + thickness * c, thickness * s, c, s});
  }
  return profile;
}

std::vector<ProfilePoint> profile_of(Shape shape) {
  switch (shape) {
    case Shape::ball:
      return circle(0, 1, 16, -kPi / 2, kPi / 2);
    case Shape::rod:
      return {{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 1, 0}, {1, 1, 1, 0}};
    case Shape::tip:
      return {{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, kSlope, kSlope}, {0, 1, kSlope, kSlope}};
    case Shape::cone:
      return {{0, 0, kSlope, -kSlope}, {1, 1, kSlope, -kSlope}};
    case Shape::ring:
      return circle(1, 0.015F, 8, 0, 2 * kPi);
    case Shape::halo:
      return circle(1, 0.1F, 8, 0, 2 * kPi);
  }
  return {};
}

}  // namespace

ShapeCorners corners_of(Shape shape) {
  const std::vector<ProfilePoint> profile = profile_of(shape);
  ShapeCorners corners;
  const auto count = static_cast<Eigen::Index>(6 * kSides * (profile.size() - 1));
  corners.positions.resize(3, count);
  corners.normals.resize(3, count);
  Eigen::Index next = 0;
  const auto add = [&](const ProfilePoint& p, int side) {
    const float angle = 2 * kPi * static_cast<float>(side) / static_cast<float>(kSides);
    const float c = std::cos(angle), s = std::sin(angle);
    corners.positions.col(next) << p.radius * c, p.radius * s, p.height;
    corners.normals.col(next++) << p.outwards * c, p.outwards * s, p.upwards;
  };
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    for (int side = 0; side < kSides; ++side) {
      add(profile[i], side);
      add(profile[i], side + 1);
      add(profile[i + 1], side + 1);
      add(profile[i], side);
      add(profile[i + 1], side + 1);
      add(profile[i + 1], side);
    }
  }
  return corners;
}

}  // namespace palpate::view
