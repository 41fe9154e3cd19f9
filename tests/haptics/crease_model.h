// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "height_field_model.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {

/// A block with V grooves along y, felt from above.
struct CreaseBlock {
  std::vector<double> openings;  ///< [degrees] between the flanks of each groove
  double friction = 0.5;
  double width = 64;   ///< [mm] along y
  double spacing = 8;  ///< [mm] of the contacts, along the surface
  double cell = 1;     ///< [mm] of the mesh, at most
  unsigned seed = 1;   ///< of the contacts' places and fields
};

/// The section of a block: a polygon z(x), known in closed form.
class CreaseProfile {
 public:
  static constexpr double kDepth = 8;  ///< [mm] of the grooves
  static constexpr double kLand = 16;  ///< [mm] flat beside each groove

  explicit CreaseProfile(const std::vector<double>& openings) {
    corners_.emplace_back(0, 0);
    for (const double opening : openings) {
      const double half = opening / 2 * std::numbers::pi / 180, wide = kDepth * std::tan(half);
      const double land = corners_.back().x() + kLand;
      corners_.emplace_back(land, 0);
      corners_.emplace_back(land + wide, -kDepth);
      corners_.emplace_back(land + 2 * wide, 0);
      bottoms_.push_back(land + wide);
    }
    corners_.emplace_back(corners_.back().x() + kLand, 0);
  }

  [[nodiscard]] const std::vector<Eigen::Vector2d>& corners() const { return corners_; }
  [[nodiscard]] double bottom(std::size_t groove) const { return bottoms_[groove]; }  ///< its x
  [[nodiscard]] double length() const {
    double sum = 0;
    for (std::size_t i = 1; i < corners_.size(); ++i) sum += (corners_[i] - corners_[i - 1]).norm();
    return sum;
  }
  /// The point this far along the section.
  [[nodiscard]] Eigen::Vector2d at(double along) const {
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const Eigen::Vector2d edge = corners_[i] - corners_[i - 1];
      if (along <= edge.norm()) return corners_[i - 1] + along / edge.norm() * edge;
      along -= edge.norm();
    }
    return corners_.back();
  }
  /// [mm] below the surface; below 0 outside, and beyond the ends of the section.
  [[nodiscard]] double depth(const Eigen::Vector3d& place) const {
    const Eigen::Vector2d point(place.x(), place.z());
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    double nearest = kInfinite, height = -kInfinite;
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const Eigen::Vector2d edge = corners_[i] - corners_[i - 1], to = point - corners_[i - 1];
      const double along = std::clamp(to.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (to - along * edge).norm());
      if (to.x() >= 0 && to.x() <= edge.x())
        height = corners_[i - 1].y() + to.x() / edge.x() * edge.y();
    }
    return point.y() < height ? nearest : -nearest;
  }

 private:
  std::vector<Eigen::Vector2d> corners_;
  std::vector<double> bottoms_;
};

/// Contacts stand at random, about `spacing` apart. No force changes by more than 2 N/mm: fields
/// have the six bases of `six_bases` with scales of 0.3 to 0.9, and lean by up to 4 degrees.
inline Model crease_model(const CreaseBlock& block) {
  const CreaseProfile profile(block.openings);
  std::vector<Eigen::Vector2d> section = {profile.corners().front()};
  for (std::size_t i = 1; i < profile.corners().size(); ++i) {
    const Eigen::Vector2d edge = profile.corners()[i] - profile.corners()[i - 1];
    const int parts = static_cast<int>(std::ceil(edge.norm() / block.cell));
    for (int k = 1; k <= parts; ++k)
      section.push_back(profile.corners()[i - 1] + static_cast<double>(k) / parts * edge);
  }
  Model model;
  model.surface = geometry::test::height_field(
      static_cast<int>(section.size()) - 1, static_cast<int>(std::ceil(block.width / block.cell)),
      block.cell, [](double, double) { return 0.0; });
  for (auto&& vertex : model.surface.vertices.colwise()) {
    const Eigen::Vector2d& at =
        section[static_cast<std::size_t>(std::lround(vertex.x() / block.cell))];
    vertex = Eigen::Vector3d(at.x(), vertex.y() - block.width / 2, at.y());
  }
  const geometry::SurfaceQuery query(model.surface);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
  std::mt19937 random(block.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<geometry::SurfacePoint> places;
  const auto count = [&](double length) { return static_cast<int>(length / block.spacing); };
  const int rows = count(block.width), columns = count(profile.length());
  for (int i = 0; i < rows * columns; ++i) {
    constexpr double kShift = 0.2;  // of the spacing
    const double along =
                     (i % columns + 0.5 + kShift * uniform(random)) * profile.length() / columns,
                 y = (i / columns + 0.5 + kShift * uniform(random)) * block.width / rows -
                     block.width / 2;
    const Eigen::Vector2d at = profile.at(along);
    const geometry::ClosestPoint place = query.closest_point({at.x(), y, at.y()});
    ContactModel contact;
    contact.id = i;
    contact.position = place.position;
    constexpr double kLean = 0.05;  // [rad] in each direction
    contact.frame =
        rotation_between(Eigen::Vector3d::UnitZ(), -normals.col(place.at.triangle)) *
        rotation_exp({kLean * uniform(random), kLean * uniform(random), uniform(random)});
    contact.field = six_bases(0.6 + 0.3 * uniform(random), uniform(random), uniform(random));
    contact.friction = block.friction;
    contact.friction_axis = contact.frame.col(2);
    contact.samples = 100;
    model.contacts.push_back(contact);
    places.push_back(place.at);
  }
  return with_triangles(std::move(model), places);
}

}  // namespace palpate::haptics
