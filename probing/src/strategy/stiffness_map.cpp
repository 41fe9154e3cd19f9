// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/stiffness_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/probing/stiffness_process.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kUnknownStiffness = std::numeric_limits<double>::quiet_NaN();
/// Standard deviations of the highest stiffness that its excess must have. It is the highest of
/// many, so that one in a few hundred of plain maps exceeds it.
constexpr double kDistinct = 3;

// [mm] the largest distance of a contact to the nearest other one
double largest_spacing(std::span<const ContactStiffness> contacts) {
  double largest = 0;
  for (const ContactStiffness& one : contacts) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const ContactStiffness& other : contacts) {
      if (&one != &other) nearest = std::min(nearest, (one.position - other.position).norm());
    }
    largest = std::max(largest, nearest);
  }
  return largest;
}

bool near_a_contact(const Vector3d& place, std::span<const ContactStiffness> contacts,
                    double reach) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const ContactStiffness& contact) {
    return (contact.position - place).norm() <= reach;
  });
}

// [mm^2] a third of the triangles around each vertex
Eigen::VectorXd vertex_areas(const geometry::TriangleMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (const auto& corners : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(corners[0]);
    const double twice =
        (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a).norm();
    for (const int corner : corners) areas(corner) += twice / 6;
  }
  return areas;
}

// The value that half of the area does not exceed.
double median_by_area(const Eigen::VectorXd& values, const Eigen::VectorXd& areas) {
  std::vector<std::pair<double, double>> known;
  double whole = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isnan(values(i)) || !(areas(i) > 0)) continue;
    known.emplace_back(values(i), areas(i));
    whole += areas(i);
  }
  std::sort(known.begin(), known.end());
  double sum = 0;
  for (const auto& [value, area] : known) {
    sum += area;
    if (sum >= whole / 2) return value;
  }
  return kUnknownStiffness;
}

// Cuts each triangle along the line on which the linear function of its corners has the threshold.
void find_contour(const geometry::TriangleMesh& mesh, StiffnessMap& map) {
  std::vector<Vector3d> ends;
  for (const Eigen::Vector3i corners : mesh.triangles.colwise()) {
    const Vector3d excess = map.stiffness(corners).array() - map.threshold;
    if (excess.hasNaN()) continue;
    const Eigen::Matrix3d at = mesh.vertices(Eigen::all, corners);
    const double area = (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0)).norm() / 2;
    const auto above = (excess.array() >= 0).count();
    if (above == 3) map.area += area;
    if (above == 0 || above == 3) continue;
    int apart = 0;  // the corner on the other side than both others
    while ((excess(apart) >= 0) != (above == 1)) ++apart;
    double part = 1;  // of the triangle, cut off with that corner
    for (const int step : {1, 2}) {
      const int other = (apart + step) % 3;
      const double share = excess(apart) / (excess(apart) - excess(other));
      ends.emplace_back(at.col(apart) + share * (at.col(other) - at.col(apart)));
      part *= share;
    }
    map.area += above == 1 ? part * area : (1 - part) * area;
  }
  map.contour.resize(3, static_cast<Eigen::Index>(ends.size()));
  for (Eigen::Index i = 0; i < map.contour.cols(); ++i)
    map.contour.col(i) = ends[static_cast<std::size_t>(i)];
}

}  // namespace

StiffnessMap stiffness_map(const geometry::TriangleMesh& surface,
                           std::span<const ContactStiffness> contacts) {
  geometry::check_mesh(surface, "stiffness_map()");
  const StiffnessProcess process(contacts);
  const double reach = largest_spacing(contacts);
  StiffnessMap map;
  map.length = process.length();
  map.stiffness = Eigen::VectorXd::Constant(surface.vertices.cols(), kUnknownStiffness);
  map.deviation = map.stiffness;
  const Eigen::VectorXd areas = vertex_areas(surface);
  parallel_for(surface.vertices.cols(), [&](Eigen::Index i) {
    const Vector3d place = surface.vertices.col(i);
    if (!(areas(i) > 0) || !near_a_contact(place, contacts, reach)) return;
    const ContactStiffness there = process.predict(place);
    map.stiffness(i) = there.stiffness;
    map.deviation(i) = there.deviation;
  });
  map.soft = median_by_area(map.stiffness, areas);
  if (std::isnan(map.soft)) {
    throw InvalidInput(
        "stiffness_map(): no vertex of the surface is near a contact; give the surface on which "
        "the contacts are");
  }
  for (const ContactStiffness& contact : contacts) {
    const ContactStiffness there = process.predict(contact.position);
    if (!(there.stiffness > map.stiff)) continue;
    map.stiff = there.stiffness;
    map.stiffest = contact.position;
    map.stiff_deviation = there.deviation;
  }
  map.threshold = (map.soft + map.stiff) / 2;
  map.distinct = map.stiff - map.soft >= kDistinct * map.stiff_deviation;
  if (map.distinct) find_contour(surface, map);
  return map;
}

}  // namespace palpate::probing
