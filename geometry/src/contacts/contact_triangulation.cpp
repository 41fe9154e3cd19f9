// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contacts/coarse_triangulation.h"
#include "palpate/core/error.h"
#include "palpate/core/work_steps.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::geometry {
namespace {

/// Two contacts coincide iff their distance is at most this fraction of the surface's bounding
/// diagonal: far above rounding, far below the repeatability of an arm.
constexpr double kSamePlace = 1e-9;

void check_apart(const Eigen::Matrix3Xd& places, double diagonal) {
  const double tolerance = kSamePlace * diagonal;
  // In the order along a line, on which the places of a grid have no two equal coordinates, unlike
  // along an axis.
  const Eigen::RowVectorXd along =
      Eigen::RowVector3d(1, 1 / std::sqrt(2.0), std::sqrt(3.0) / std::numbers::pi).normalized() *
      places;
  std::vector<int> order(static_cast<size_t>(places.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&along](int i) { return along[i]; });
  for (size_t k = 0; k < order.size(); ++k) {
    for (size_t l = k + 1; l < order.size(); ++l) {
      const int i = std::min(order[k], order[l]);
      const int j = std::max(order[k], order[l]);
      if (along[order[l]] - along[order[k]] > tolerance) break;
      if ((places.col(i) - places.col(j)).norm() > tolerance) continue;
      throw InvalidInput("triangulate_contacts: contacts " + std::to_string(i) + " and " +
                         std::to_string(j) + " are at the same place; remove one of them");
    }
  }
}

using Triangles = std::vector<std::array<int, 3>>;

/// The triangles at each vertex, in ascending order.
class Stars {
 public:
  Stars(const Triangles& triangles, int vertex_count)
      : first_(static_cast<size_t>(vertex_count) + 1, 0), stars_(3 * triangles.size()) {
    for (const auto& corners : triangles) {
      for (const int corner : corners) ++first_[static_cast<size_t>(corner) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<size_t> end(first_.begin(), first_.end() - 1);
    for (size_t t = 0; t < triangles.size(); ++t) {
      for (const int corner : triangles[t]) stars_[end[static_cast<size_t>(corner)]++] = t;
    }
  }
  [[nodiscard]] std::span<const size_t> of(int vertex) const {
    const auto v = static_cast<size_t>(vertex);
    return std::span(stars_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<size_t> first_, stars_;
};

/// Groups a vertex's triangles (indices into `triangles`) into fans of triangles connected across
/// edges at the vertex. In a manifold there is one fan.
std::vector<std::vector<size_t>> fans_around(int vertex, std::span<const size_t> star,
                                             const std::vector<char>& dropped,
                                             const Triangles& triangles) {
  std::map<int, size_t> by_next;  // by the corner after the vertex
  std::set<int> lasts;            // the corners before it
  for (const size_t t : star) {
    if (dropped[t] != 0) continue;
    const auto k =
        static_cast<size_t>(std::ranges::find(triangles[t], vertex) - triangles[t].begin());
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
  // Open fans start where no triangle ends; the remaining ones are closed.
  std::vector<int> beginnings;
  for (const auto& [next, triangle] : by_next) {
    if (!lasts.contains(next)) beginnings.push_back(next);
  }
  for (const int next : beginnings) walk_from(next);
  while (!by_next.empty()) walk_from(by_next.begin()->first);
  return fans;
}

/// Keeps only the largest of several fans that touch in one vertex, the first one of equals.
Triangles keep_vertices_manifold(const Triangles& triangles, int vertex_count) {
  const Stars stars(triangles, vertex_count);
  std::vector<char> dropped(triangles.size(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (int vertex = 0; vertex < vertex_count; ++vertex) {
      std::vector<std::vector<size_t>> fans =
          fans_around(vertex, stars.of(vertex), dropped, triangles);
      if (fans.size() < 2) continue;
      changed = true;
      std::ranges::stable_sort(fans, std::greater{}, &std::vector<size_t>::size);
      for (size_t i = 1; i < fans.size(); ++i) {
        for (const size_t t : fans[i]) dropped[t] = 1;
      }
    }
  }
  Triangles kept;
  for (size_t t = 0; t < triangles.size(); ++t) {
    if (dropped[t] == 0) kept.push_back(triangles[t]);
  }
  return kept;
}

}  // namespace

const char* to_string(ContactTriangulationMethod method) {
  switch (method) {
    case ContactTriangulationMethod::delaunay:
      return "delaunay";
    case ContactTriangulationMethod::voronoi_dual:
      return "voronoi_dual";
  }
  return "unknown";
}

Eigen::Matrix3Xd places_of_contacts(const TriangleMesh& surface,
                                    std::span<const SurfacePoint> contacts) {
  check_mesh(surface, "triangulate_contacts");
  if (contacts.size() < 3) {
    throw InvalidInput("triangulate_contacts: got " + std::to_string(contacts.size()) +
                       " contacts; a triangulation needs at least three");
  }
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(contacts.size()));
  for (size_t i = 0; i < contacts.size(); ++i) {
    const std::string what = "triangulate_contacts: contact " + std::to_string(i);
    check_surface_point(surface, contacts[i], what.c_str());
    places.col(static_cast<Eigen::Index>(i)) = position(surface, contacts[i]);
  }
  check_apart(places, bounding_diagonal(surface));
  return places;
}

ContactTriangulation with_manifold_vertices(TrianglesOfContacts found, Eigen::Matrix3Xd places) {
  const auto contact_count = static_cast<size_t>(places.cols());
  const Triangles triangles =
      keep_vertices_manifold(found.triangles, static_cast<int>(contact_count));
  ContactTriangulation result;
  result.mesh.vertices = std::move(places);
  result.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  std::vector<bool> used(contact_count, false);
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
  result.weights = std::move(found.weights);
  result.surface_labels = std::move(found.surface_labels);
  result.intrinsic = std::move(found.intrinsic);
  return result;
}

ContactTriangulation triangulate_contacts(const TriangleMesh& surface,
                                          std::span<const SurfacePoint> contacts,
                                          const ContactTriangulationOptions& options) {
  Eigen::Matrix3Xd places = places_of_contacts(surface, contacts);
  // One step for each vertex to be removed, and one for the rest.
  WorkSteps steps(options.progress, static_cast<int>(surface.vertices.cols()) + 1);
  const bool by_dual = options.method == ContactTriangulationMethod::voronoi_dual;
  TrianglesOfContacts found = by_dual
                                  ? voronoi_dual(surface, contacts, places)
                                  : CoarsenedSurface(surface, contacts, places, steps).triangles();
  steps.tell(0);
  ContactTriangulation result = with_manifold_vertices(std::move(found), std::move(places));
  if (by_dual && result.mesh.triangles.cols() == 0) {
    throw InvalidInput(
        "triangulate_contacts: nowhere on the surface do the cells of three of the " +
        std::to_string(contacts.size()) +
        " contacts meet; contacts on one line, on separate parts or closer together "
        "than the surface's vertices give no triangle");
  }
  if (by_dual) result.weights = project_weights(surface, result.mesh);
  steps.end();
  return result;
}

SurfaceWeights project_weights(const TriangleMesh& surface, const TriangleMesh& contact_mesh) {
  const SurfaceQuery query(contact_mesh);
  SurfaceWeights result{.contacts = Eigen::Matrix3Xi::Constant(3, surface.vertices.cols(), -1),
                        .weights = Eigen::Matrix3Xd::Zero(3, surface.vertices.cols())};
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
    const SurfacePoint at = query.closest_point(surface.vertices.col(v)).at;
    if (at.triangle < 0) continue;
    std::array<int, 3> order = {0, 1, 2};
    std::ranges::stable_sort(order, std::greater{}, [&](int k) { return at.barycentric[k]; });
    for (int k = 0; k < 3; ++k) {
      const int corner = order[static_cast<size_t>(k)];
      if (!(at.barycentric[corner] > 0)) continue;
      result.contacts(k, v) = contact_mesh.triangles(corner, at.triangle);
      result.weights(k, v) = at.barycentric[corner];
    }
  }
  return result;
}

}  // namespace palpate::geometry
