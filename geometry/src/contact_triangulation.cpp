// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {
namespace {

/// Two contacts are at one place iff they are no further apart than this fraction of the surface's
/// bounding diagonal: far above rounding, far below what an arm can repeat.
constexpr double kSamePlace = 1e-9;

/// Three cells that meet: what may become a triangle.
struct Meeting {
  double radius;                ///< [mm] distance from the place of meeting to the contacts
  std::array<int, 3> contacts;  ///< in the surface's sense of rotation, the lowest first
  auto operator<=>(const Meeting&) const = default;
};

void check_apart(const Eigen::Matrix3Xd& places, double diagonal) {
  const double tolerance = kSamePlace * diagonal;
  std::vector<int> order(static_cast<size_t>(places.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&places](int i) { return places(0, i); });
  for (size_t k = 0; k < order.size(); ++k) {
    for (size_t l = k + 1; l < order.size(); ++l) {
      const int i = std::min(order[k], order[l]);
      const int j = std::max(order[k], order[l]);
      if (places(0, order[l]) - places(0, order[k]) > tolerance) break;
      if ((places.col(i) - places.col(j)).norm() > tolerance) continue;
      throw InvalidInput("triangulate_contacts: contacts " + std::to_string(i) + " and " +
                         std::to_string(j) + " are at the same place; remove one of them");
    }
  }
}

/// The lowest label first, without changing the sense of rotation.
std::array<int, 3> lowest_first(std::array<int, 3> labels) {
  std::ranges::rotate(labels, std::ranges::min_element(labels));
  return labels;
}

/// Every place where three cells meet, the nearest to its contacts first: there the surface is
/// sampled best.
std::vector<Meeting> find_meetings(const TriangleMesh& surface, const GeodesicDistance& geodesic) {
  std::vector<Meeting> meetings;
  for (const Eigen::Vector3i corners : surface.triangles.colwise()) {
    const std::array<int, 3> labels = lowest_first(
        {geodesic.label[corners[0]], geodesic.label[corners[1]], geodesic.label[corners[2]]});
    const bool all_differ =
        labels[0] != labels[1] && labels[1] != labels[2] && labels[2] != labels[0];
    if (labels[0] < 0 || !all_differ) continue;
    meetings.push_back({.radius = geodesic.distance(corners).maxCoeff(), .contacts = labels});
  }
  std::ranges::sort(meetings);
  return meetings;
}

/// Half the straight distance from each contact to its nearest neighbour: a disk inside its cell.
Eigen::VectorXd disk_radii(const Eigen::Matrix3Xd& places) {
  Eigen::VectorXd radii(places.cols());
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    Eigen::VectorXd squared = (places.colwise() - places.col(i)).colwise().squaredNorm();
    squared[i] = std::numeric_limits<double>::infinity();
    radii[i] = std::sqrt(squared.minCoeff()) / 2;
  }
  return radii;
}

/// Unit normals at the contacts, 3 x contacts: means over the contact's triangle and over a disk,
/// in which the roughness of the surface averages out.
Eigen::Matrix3Xd contact_normals(const TriangleMesh& surface, const GeodesicDistance& geodesic,
                                 std::span<const SurfacePoint> contacts,
                                 const Eigen::VectorXd& radii) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, radii.size());
  const auto area = [&surface](Eigen::Index t) -> Eigen::Vector3d {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Eigen::Vector3d a = surface.vertices.col(corners[0]);
    return (surface.vertices.col(corners[1]) - a).cross(surface.vertices.col(corners[2]) - a);
  };
  for (size_t i = 0; i < contacts.size(); ++i) {
    normals.col(static_cast<Eigen::Index>(i)) = area(contacts[i].triangle);
  }
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (const int corner : surface.triangles.col(t)) {
      const int label = geodesic.label[corner];
      if (label >= 0 && geodesic.distance[corner] <= radii[label]) normals.col(label) += area(t);
    }
  }
  return normals.colwise().normalized();
}

/// The triangle is turned over against the surface at its contacts, or has no area. On a closed
/// surface that is touched on one side only, such are the cells that meet behind it.
bool folds_over(const std::array<int, 3>& contacts, const Eigen::Matrix3Xd& places,
                const Eigen::Matrix3Xd& normals) {
  const auto& [a, b, c] = contacts;
  const Eigen::Vector3d ab = places.col(b) - places.col(a);
  const Eigen::Vector3d ac = places.col(c) - places.col(a);
  return ab.cross(ac).dot(normals.col(a) + normals.col(b) + normals.col(c)) <= 0;
}

using Triangles = std::vector<std::array<int, 3>>;

/// Triangles such that every edge has at most one on each side.
Triangles keep_edges_manifold(const std::vector<Meeting>& meetings, const Eigen::Matrix3Xd& places,
                              const Eigen::Matrix3Xd& normals) {
  Triangles triangles;
  std::set<std::pair<int, int>> sides;
  for (const Meeting& meeting : meetings) {
    const auto& [a, b, c] = meeting.contacts;
    const std::array<std::pair<int, int>, 3> own = {{{a, b}, {b, c}, {c, a}}};
    const bool taken =
        std::ranges::any_of(own, [&sides](const auto& side) { return sides.contains(side); });
    if (taken || folds_over(meeting.contacts, places, normals)) continue;
    sides.insert(own.begin(), own.end());
    triangles.push_back(meeting.contacts);
  }
  return triangles;
}

/// A vertex's triangles in fans, each of triangles that follow one another across edges at the
/// vertex; positions in `triangles`. In a manifold there is one.
std::vector<std::vector<size_t>> fans_around(int vertex, const Triangles& triangles) {
  std::map<int, size_t> by_next;  // by the corner after the vertex
  std::set<int> lasts;            // the corners before it
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto at = std::ranges::find(triangles[t], vertex);
    if (at == triangles[t].end()) continue;
    const auto k = static_cast<size_t>(at - triangles[t].begin());
    by_next.emplace(triangles[t][(k + 1) % 3], t);
    lasts.insert(triangles[t][(k + 2) % 3]);
  }
  std::vector<std::vector<size_t>> fans;
  const auto walk_from = [&](int next) {
    std::vector<size_t>& fan = fans.emplace_back();
    for (auto found = by_next.find(next); found != by_next.end(); found = by_next.find(next)) {
      const std::array<int, 3>& corners = triangles[found->second];
      const auto k = static_cast<size_t>(std::ranges::find(corners, vertex) - corners.begin());
      next = corners[(k + 2) % 3];
      fan.push_back(found->second);
      by_next.erase(found);
    }
  };
  // Open fans begin where no triangle ends; what is left then are closed ones.
  std::vector<int> beginnings;
  for (const auto& [next, triangle] : by_next) {
    if (!lasts.contains(next)) beginnings.push_back(next);
  }
  for (const int next : beginnings) walk_from(next);
  while (!by_next.empty()) walk_from(by_next.begin()->first);
  return fans;
}

/// Of several fans that touch in one vertex only the largest stays, the first of equals.
Triangles keep_vertices_manifold(Triangles triangles, int vertex_count) {
  for (bool changed = true; changed;) {
    changed = false;
    for (int vertex = 0; vertex < vertex_count; ++vertex) {
      std::vector<std::vector<size_t>> fans = fans_around(vertex, triangles);
      if (fans.size() < 2) continue;
      changed = true;
      std::ranges::stable_sort(fans, std::greater{}, &std::vector<size_t>::size);
      std::set<size_t> dropped;
      for (size_t i = 1; i < fans.size(); ++i) dropped.insert(fans[i].begin(), fans[i].end());
      Triangles kept;
      for (size_t t = 0; t < triangles.size(); ++t) {
        if (!dropped.contains(t)) kept.push_back(triangles[t]);
      }
      triangles = std::move(kept);
    }
  }
  return triangles;
}

}  // namespace

ContactTriangulation triangulate_contacts(const TriangleMesh& surface,
                                          std::span<const SurfacePoint> contacts) {
  check_mesh(surface, "triangulate_contacts");
  if (contacts.size() < 3) {
    throw InvalidInput("triangulate_contacts: got " + std::to_string(contacts.size()) +
                       " contacts; a triangulation needs at least three");
  }
  ContactTriangulation result;
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(contacts.size()));
  for (size_t i = 0; i < contacts.size(); ++i) {
    const std::string what = "triangulate_contacts: contact " + std::to_string(i);
    check_surface_point(surface, contacts[i], what.c_str());
    result.mesh.vertices.col(static_cast<Eigen::Index>(i)) = position(surface, contacts[i]);
  }
  check_apart(result.mesh.vertices, bounding_diagonal(surface));

  GeodesicDistance geodesic = geodesic_distance(surface, contacts);
  const Eigen::Matrix3Xd& places = result.mesh.vertices;
  const Eigen::Matrix3Xd normals = contact_normals(surface, geodesic, contacts, disk_radii(places));
  const Triangles triangles =
      keep_vertices_manifold(keep_edges_manifold(find_meetings(surface, geodesic), places, normals),
                             static_cast<int>(contacts.size()));
  if (triangles.empty()) {
    throw InvalidInput(
        "triangulate_contacts: nowhere on the surface do the cells of three of the " +
        std::to_string(contacts.size()) +
        " contacts meet; contacts on one line, on separate parts or closer together "
        "than the surface's vertices give no triangle");
  }
  result.surface_labels = std::move(geodesic.label);
  result.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  std::vector<bool> used(contacts.size(), false);
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      result.mesh.triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) =
          triangles[t][k];
      used[static_cast<size_t>(triangles[t][k])] = true;
    }
  }
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) result.isolated.push_back(static_cast<int>(i));
  }
  return result;
}

ContactLocator::ContactLocator(const TriangleMesh& contact_mesh)
    : triangles_(contact_mesh.triangles), query_(contact_mesh) {}

ContactWeights ContactLocator::locate(const Eigen::Vector3d& point) const noexcept {
  const SurfacePoint at = query_.closest_point(point).at;
  if (at.triangle < 0) return {};
  return {.contacts = triangles_.col(at.triangle), .weights = at.barycentric};
}

}  // namespace palpate::geometry
