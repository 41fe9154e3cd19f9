// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_measures.h"

#include <Eigen/Geometry>
#include <string>

#include "mesh/triangle_primitives.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {

double surface_area(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  double area = 0;
  for (const auto& triangle : mesh.triangles.colwise()) {
    area += area_vector(mesh.vertices, triangle).norm();
  }
  return area;
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
  return six_times / 6;
}

}  // namespace palpate::geometry
