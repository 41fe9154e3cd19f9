// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/coarse_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/geometry/geodesic_distance.h"

namespace palpate::geometry {
namespace {

/// Three cells that meet: a candidate triangle.
struct Meeting {
  double radius;                ///< [mm] distance from the meeting place to the contacts
  std::array<int, 3> contacts;  ///< oriented like the surface, the lowest first
};

/// Rotates the labels so that the lowest is first, without changing the orientation.
std::array<int, 3> lowest_first(std::array<int, 3> labels) {
  std::rotate(labels.begin(), std::ranges::min_element(labels), labels.end());
  return labels;
}

/// All places where three cells meet, those nearest to their contacts first, where the sampling is
/// best.
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
  std::ranges::sort(meetings, {}, [](const Meeting& meeting) {
    return std::tie(meeting.radius, meeting.contacts);
  });
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

/// Unit normals at the contacts, 3 x contacts: means over the contact's triangle and over a disk
/// that averages out the roughness of the surface.
Eigen::Matrix3Xd contact_normals(const TriangleMesh& surface, const GeodesicDistance& geodesic,
                                 std::span<const SurfacePoint> contacts,
                                 const Eigen::VectorXd& radii) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, radii.size());
  const auto area = [&surface](Eigen::Index t) {
    return area_vector(surface.vertices, surface.triangles.col(t));
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

/// Returns true if the triangle is flipped relative to the surface at its contacts, or has no area.
/// On a closed surface with contacts on one side, this applies to the cells that meet behind it.
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

}  // namespace

TrianglesOfContacts voronoi_dual(const TriangleMesh& surface,
                                 std::span<const SurfacePoint> contacts,
                                 const Eigen::Matrix3Xd& places) {
  GeodesicDistance geodesic = geodesic_distance(surface, contacts);
  const Eigen::Matrix3Xd normals = contact_normals(surface, geodesic, contacts, disk_radii(places));
  TrianglesOfContacts result;
  result.triangles = keep_edges_manifold(find_meetings(surface, geodesic), places, normals);
  result.surface_labels = std::move(geodesic.label);
  return result;
}

}  // namespace palpate::geometry
