// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::probing {
namespace {

using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;  // as the triangle on its left has it

/// The direction from which the surface is seen.
Eigen::Vector3d mean_normal(std::span<const Contact> contacts) {
  constexpr double kSteepest = 0.258819;  // cosine of 75 degrees
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Contact& contact : contacts) sum += contact.normal.normalized();
  Eigen::Vector3d mean = sum.normalized();
  for (const Contact& contact : contacts) {
    if (contact.normal.normalized().dot(mean) > kSteepest) continue;
    throw InvalidInput("contact_surface(): the normal of contact " + std::to_string(contact.id) +
                       " is more than 75 degrees from the mean of all; a surface can only be made "
                       "of contacts on one side of an object. Scan the object, or import each side "
                       "on its own");
  }
  return mean;
}

/// Positions in the plane across `normal`, in the whole numbers from which Voronoi cells are made.
std::vector<std::array<std::int32_t, 2>> in_plane(std::span<const Contact> contacts,
                                                  const Eigen::Vector3d& normal) {
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Vector3d p = contacts[i].position - contacts[0].position;
    places.col(static_cast<Eigen::Index>(i)) = Eigen::Vector2d(p.dot(x), p.dot(y));
  }
  constexpr double kLargest = 1 << 30;
  const double scale = kLargest / places.cwiseAbs().maxCoeff();
  std::vector<std::array<std::int32_t, 2>> result;
  std::map<std::array<std::int32_t, 2>, long long> taken;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Vector2d p = scale * places.col(static_cast<Eigen::Index>(i));
    result.push_back({static_cast<std::int32_t>(std::lround(p.x())),
                      static_cast<std::int32_t>(std::lround(p.y()))});
    const auto [other, added] = taken.emplace(result.back(), contacts[i].id);
    if (added) continue;
    throw InvalidInput("contact_surface(): contacts " + std::to_string(other->second) + " and " +
                       std::to_string(contacts[i].id) +
                       " are behind each other, seen along the mean normal; a surface can only be "
                       "made of contacts on one side of an object");
  }
  return result;
}

/// Counter-clockwise triangles; contacts on a common circle are a fan.
std::vector<Triangle> delaunay(const std::vector<std::array<std::int32_t, 2>>& places) {
  std::vector<boost::polygon::point_data<std::int32_t>> points;
  points.reserve(places.size());
  for (const auto& [x, y] : places) points.emplace_back(x, y);
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(points.begin(), points.end(), &diagram);
  std::vector<Triangle> triangles;
  for (const auto& vertex : diagram.vertices()) {
    std::vector<int> around;
    const auto* edge = vertex.incident_edge();
    do {
      around.push_back(static_cast<int>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    for (std::size_t i = 2; i < around.size(); ++i) {
      Triangle triangle = {around[0], around[i - 1], around[i]};
      const auto at = [&](int k) {
        const auto& place = places[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
        return Eigen::Vector2d(place[0], place[1]);
      };
      const Eigen::Vector2d u = at(1) - at(0), v = at(2) - at(0);
      const double area = u.x() * v.y() - u.y() * v.x();
      if (area < 0) std::swap(triangle[1], triangle[2]);
      if (area != 0) triangles.push_back(triangle);
    }
  }
  return triangles;
}

/// Left out from the border inwards.
class Trimming {
 public:
  Trimming(std::span<const Contact> contacts, std::vector<Triangle> triangles)
      : contacts_(contacts), triangles_(std::move(triangles)) {}

  /// Triangles that bridge gaps.
  void remove_long(double factor) {
    std::vector<double> lengths;
    for (const Triangle& triangle : triangles_)
      for (std::size_t k = 0; k < 3; ++k) lengths.push_back(length(triangle, k));
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::ranges::nth_element(lengths, middle);
    const double longest = factor * *middle;
    std::erase_if(triangles_, [&](const Triangle& triangle) {
      return length(triangle, 0) > longest || length(triangle, 1) > longest ||
             length(triangle, 2) > longest;
    });
  }

  /// Flat triangles at the border, such as between nearly collinear contacts of its lines.
  void remove_needles() {
    constexpr double kLeastHeight = 0.1;  // of the edge at the border
    for (bool removed = true; removed;) {
      std::map<Edge, int> edges;
      for (const Triangle& triangle : triangles_)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{triangle[k], triangle[(k + 1) % 3]}];
      removed = std::erase_if(triangles_, [&](const Triangle& triangle) {
                  for (std::size_t k = 0; k < 3; ++k) {
                    const bool at_border = !edges.contains({triangle[(k + 1) % 3], triangle[k]});
                    const double base = length(triangle, k);
                    if (at_border && twice_area(triangle) < kLeastHeight * base * base) return true;
                  }
                  return false;
                }) > 0;
    }
  }

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  [[nodiscard]] const Eigen::Vector3d& at(int contact) const {
    return contacts_[static_cast<std::size_t>(contact)].position;
  }
  [[nodiscard]] double length(const Triangle& triangle, std::size_t k) const {
    return (at(triangle[(k + 1) % 3]) - at(triangle[k])).norm();
  }
  [[nodiscard]] double twice_area(const Triangle& t) const {
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm();
  }

  std::span<const Contact> contacts_;
  std::vector<Triangle> triangles_;
};

void check_triangles(std::span<const Contact> contacts, const std::vector<Triangle>& triangles) {
  std::vector<bool> used(contacts.size(), false);
  for (const Triangle& t : triangles) {
    std::array<const Contact*, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      used[static_cast<std::size_t>(t[k])] = true;
      corners[k] = &contacts[static_cast<std::size_t>(t[k])];
    }
    const Eigen::Vector3d across = (corners[1]->position - corners[0]->position)
                                       .cross(corners[2]->position - corners[0]->position);
    for (const Contact* const corner : corners) {
      if (across.dot(corner->normal) > 0) continue;
      throw InvalidInput("contact_surface(): the triangle of contacts " +
                         std::to_string(corners[0]->id) + ", " + std::to_string(corners[1]->id) +
                         " and " + std::to_string(corners[2]->id) +
                         " faces away from the normal of contact " + std::to_string(corner->id) +
                         ": the surface is folded there, or the normal is wrong; probe more "
                         "densely, scan the object, or check the normals");
    }
  }
  const auto alone = std::ranges::find(used, false);
  if (alone == used.end()) return;
  throw InvalidInput(
      "contact_surface(): contact " +
      std::to_string(contacts[static_cast<std::size_t>(alone - used.begin())].id) +
      " is in no triangle: it is too far from the others, or in a line with them; remove it, or "
      "probe around it");
}

}  // namespace

geometry::TriangleMesh contact_surface(std::span<const Contact> contacts,
                                       const ContactSurfaceOptions& options) {
  require("ContactSurfaceOptions::longest_edge", options.longest_edge, above(1).finite());
  if (contacts.size() < 3) {
    throw InvalidInput("contact_surface(): there are " + std::to_string(contacts.size()) +
                       " contacts; a surface needs at least three");
  }
  const Eigen::Vector3d normal = mean_normal(contacts);
  Trimming trimming(contacts, delaunay(in_plane(contacts, normal)));
  if (trimming.triangles().empty())
    throw InvalidInput(
        "contact_surface(): all contacts are in a line; a surface needs contacts on "
        "both sides of it");
  trimming.remove_long(options.longest_edge);
  trimming.remove_needles();
  check_triangles(contacts, trimming.triangles());
  geometry::TriangleMesh mesh{
      Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(contacts.size())),
      Eigen::Matrix3Xi(3, static_cast<Eigen::Index>(trimming.triangles().size()))};
  for (std::size_t i = 0; i < contacts.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
  for (std::size_t i = 0; i < trimming.triangles().size(); ++i) {
    const Triangle& t = trimming.triangles()[i];
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i(t[0], t[1], t[2]);
  }
  return mesh;
}

}  // namespace palpate::probing
