// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "base/numbers.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"

namespace palpate::geometry {
namespace {

/// Angle between two edges; unlike the arc cosine it is accurate for all angles.
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

void check_mesh(const TriangleMesh& mesh, const char* what) {
  const auto refuse = [what](const std::string& reason) {
    throw InvalidInput(std::string(what) + ": " + reason);
  };
  if (mesh.triangles.cols() == 0) refuse("the mesh has no triangles; at least one is needed");
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    if (!mesh.vertices.col(v).allFinite()) {
      refuse("vertex " + std::to_string(v) + " is not finite; remove it and its triangles");
    }
  }
  const Eigen::Index vertex_count = mesh.vertices.cols();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    for (const int corner : corners) {
      if (corner < 0 || corner >= vertex_count) {
        refuse("triangle " + std::to_string(t) + " names vertex " + std::to_string(corner) +
               "; the mesh has vertices 0 to " + std::to_string(vertex_count - 1));
      }
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      refuse("triangle " + std::to_string(t) + " names a vertex twice (" +
             std::to_string(corners[0]) + ", " + std::to_string(corners[1]) + ", " +
             std::to_string(corners[2]) + "); its three vertices must differ");
    }
  }
}

void check_surface_point(const TriangleMesh& mesh, const SurfacePoint& point, const char* what) {
  const auto refuse = [what](const std::string& reason) {
    throw InvalidInput(std::string(what) + ": " + reason);
  };
  if (point.triangle < 0 || point.triangle >= mesh.triangles.cols()) {
    refuse("triangle " + std::to_string(point.triangle) + " is not one of the mesh's 0 to " +
           std::to_string(mesh.triangles.cols() - 1));
  }
  // Written so that NaN is rejected.
  const bool inside = (point.barycentric.array() >= -kBarycentricTolerance).all() &&
                      std::abs(point.barycentric.sum() - 1) <= kBarycentricTolerance;
  if (!inside) {
    refuse("barycentric coordinates (" + std::to_string(point.barycentric[0]) + ", " +
           std::to_string(point.barycentric[1]) + ", " + std::to_string(point.barycentric[2]) +
           ") must be >= 0 and sum to 1");
  }
}

Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Eigen::Vector3i corners = mesh.triangles.col(point.triangle);
  return point_on(
      {mesh.vertices.col(corners[0]), mesh.vertices.col(corners[1]), mesh.vertices.col(corners[2])},
      point.barycentric);
}

SurfacePoint corner_point(int triangle, int corner) {
  return {.triangle = triangle, .barycentric = Eigen::Vector3d::Unit(corner)};
}

std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh) {
  std::vector<SurfacePoint> points(static_cast<std::size_t>(mesh.vertices.cols()));
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      SurfacePoint& point = points[static_cast<std::size_t>(mesh.triangles(k, t))];
      if (point.triangle < 0) point = corner_point(t, k);
    }
  }
  return points;
}

std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh, std::span<const int> vertices,
                                        const char* what) {
  check_mesh(mesh, what);
  const std::vector<SurfacePoint> all = vertex_points(mesh);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto vertex = static_cast<std::size_t>(vertices[i]);
    std::string name = what;
    name.append("[").append(std::to_string(i)).append("] is ").append(std::to_string(vertices[i]));
    if (vertex >= all.size())
      throw InvalidInput(name + "; the mesh has " + std::to_string(all.size()) + " vertices");
    if (all[vertex].triangle < 0) throw InvalidInput(name + ", a vertex in no triangle");
    points.push_back(all[vertex]);
  }
  return points;
}

Eigen::Matrix3Xd triangle_normals(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd normals(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    normals.col(t) = unit_normal({mesh.vertices.col(corners[0]), mesh.vertices.col(corners[1]),
                                  mesh.vertices.col(corners[2])});
  }
  return normals;
}

Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xd of_triangles = triangle_normals(mesh);
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (!of_triangles.col(t).allFinite()) continue;
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d apex = mesh.vertices.col(corners[k]);
      const Eigen::Vector3d to_next = mesh.vertices.col(corners[(k + 1) % 3]) - apex;
      const Eigen::Vector3d to_last = mesh.vertices.col(corners[(k + 2) % 3]) - apex;
      const double angle = angle_between(to_next.stableNormalized(), to_last.stableNormalized());
      sums.col(corners[k]) += angle * of_triangles.col(t);
    }
  }
  for (Eigen::Index v = 0; v < sums.cols(); ++v) {
    const double length = sums.col(v).norm();
    if (length > 0) {
      sums.col(v) /= length;
    } else {
      sums.col(v).setConstant(kNan);
    }
  }
  return sums;
}

// Here, because the web player has no other measures.
Eigen::AlignedBox3d bounding_box(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const int v : mesh.triangles.reshaped()) box.extend(mesh.vertices.col(v));
  return box;
}

double bounding_diagonal(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

}  // namespace palpate::geometry
