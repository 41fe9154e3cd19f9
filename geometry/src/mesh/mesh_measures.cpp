// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "base/numbers.h"
#include "mesh/edge_table.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {

namespace {

/// Refuses a measure that exceeds the largest number, or is NaN because parts of it do.
double representable(double measure, const char* what) {
  if (std::isfinite(measure)) return measure;
  throw InvalidInput(std::string("mesh: its ") + what +
                     " exceeds the largest number; are its coordinates in mm?");
}

}  // namespace

double surface_area(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  double area = 0;
  for (const auto& triangle : mesh.triangles.colwise()) {
    area += area_vector(mesh.vertices, triangle).norm();
  }
  return representable(area, "area");
}

double enclosed_volume(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  for (int h = 0; h < opposite.size(); ++h) {
    if (opposite(h % 3, h / 3) >= 0) continue;
    throw InvalidInput("mesh: encloses no volume, for the edge from vertex " +
                       std::to_string(mesh.triangles(h % 3, h / 3)) + " to vertex " +
                       std::to_string(mesh.triangles((h + 1) % 3, h / 3)) +
                       " is at its border; close the mesh first");
  }
  // Use a point of the mesh as the apex: large tetrahedra from a far origin would cancel.
  const Eigen::Vector3d origin = mesh.vertices.col(mesh.triangles(0, 0));
  double six_times = 0;
  for (const auto& corners : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(corners[0]) - origin;
    const Eigen::Vector3d b = mesh.vertices.col(corners[1]) - origin;
    const Eigen::Vector3d c = mesh.vertices.col(corners[2]) - origin;
    six_times += a.dot(b.cross(c));
  }
  return representable(six_times / 6, "volume");
}

MeshShape mesh_shape(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  std::vector<double> lengths;
  for_each_edge(sort_sides(mesh.triangles), [&](std::span<const EdgeSide> sides) {
    lengths.push_back(
        (mesh.vertices.col(sides.front().high) - mesh.vertices.col(sides.front().low)).norm());
  });
  std::vector<double> smallest;
  MeshShape shape{.edges = static_cast<Eigen::Index>(lengths.size())};
  for (const auto& corners : mesh.triangles.colwise()) {
    double least = kInfinity;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = mesh.vertices.col(corners[k]);
      const Eigen::Vector3d a = mesh.vertices.col(corners[(k + 1) % 3]) - at;
      const Eigen::Vector3d b = mesh.vertices.col(corners[(k + 2) % 3]) - at;
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
      least = std::min(least, angle);
      shape.largest_angle = std::max(shape.largest_angle, angle);
    }
    smallest.push_back(least);
  }
  constexpr double kHalf = 0.5;
  shape.shortest_edge = *std::min_element(lengths.begin(), lengths.end());
  shape.median_edge = quantile(lengths, kHalf);
  shape.mean_edge =
      std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  shape.longest_edge = *std::max_element(lengths.begin(), lengths.end());
  shape.smallest_angle = *std::min_element(smallest.begin(), smallest.end());
  shape.median_smallest_angle = quantile(smallest, kHalf);
  return shape;
}

}  // namespace palpate::geometry
