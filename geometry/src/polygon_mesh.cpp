// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "polygon_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "palpate/error.h"

namespace palpate::geometry {
namespace {

using Polygon = std::span<const std::int64_t>;

/// Normal of a polygon that need not be plane or convex (Newell's method); its length is twice the
/// area.
Eigen::Vector3d polygon_normal(const PolygonMesh& mesh, const std::vector<int>& polygon) {
  const Eigen::Vector3d& origin = mesh.vertices[static_cast<std::size_t>(polygon[0])];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal += (mesh.vertices[static_cast<std::size_t>(polygon[i])] - origin)
                  .cross(mesh.vertices[static_cast<std::size_t>(polygon[i + 1])] - origin);
  return normal;
}

/// Twice the area of the triangle as seen along `normal`; negative if it is clockwise.
double turn(const PolygonMesh& mesh, const Eigen::Vector3d& normal,
            const Eigen::Vector3i& triangle) {
  const auto vertex = [&](int i) { return mesh.vertices[static_cast<std::size_t>(triangle[i])]; };
  const Eigen::Vector3d a = vertex(0);
  return (vertex(1) - a).cross(vertex(2) - a).dot(normal);
}

/// An ear is a convex corner whose triangle holds no other corner of the polygon.
bool is_ear(const PolygonMesh& mesh, const Eigen::Vector3d& normal, const std::vector<int>& polygon,
            const Eigen::Vector3i& triangle) {
  if (!(turn(mesh, normal, triangle) > 0)) return false;
  return std::none_of(polygon.begin(), polygon.end(), [&](int other) {
    if ((triangle.array() == other).any()) return false;
    for (int edge = 0; edge < 3; ++edge)
      if (turn(mesh, normal, {triangle[edge], triangle[(edge + 1) % 3], other}) < 0) return false;
    return true;
  });
}

void clip_ears(const PolygonMesh& mesh, std::vector<int> polygon,
               std::vector<Eigen::Vector3i>& triangles) {
  const Eigen::Vector3d normal = polygon_normal(mesh, polygon);
  // A clipped ear is followed by the next corner but one: a convex polygon then needs one round,
  // and its triangles are less slender than those of a fan.
  std::size_t corner = 0;
  std::size_t refused = 0;
  while (polygon.size() > 3) {
    const std::size_t size = polygon.size();
    corner %= size;
    const Eigen::Vector3i triangle(polygon[corner], polygon[(corner + 1) % size],
                                   polygon[(corner + 2) % size]);
    // A polygon that crosses itself or has no area may have no ear; any corner will do then.
    if (refused < size && !is_ear(mesh, normal, polygon, triangle)) {
      ++corner;
      ++refused;
      continue;
    }
    triangles.push_back(triangle);
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>((corner + 1) % size));
    ++corner;
    refused = 0;
  }
  triangles.emplace_back(polygon[0], polygon[1], polygon[2]);
}

void check_polygon(const PolygonMesh& mesh, const std::string& file, std::size_t face,
                   Polygon corners) {
  const std::string place = file + ": face " + std::to_string(face);
  if (corners.size() < 3)
    throw FileError(place + " has " + std::to_string(corners.size()) +
                    " corners; at least 3 are needed");
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (corners[i] < 0 || corners[i] >= static_cast<std::int64_t>(mesh.vertices.size()))
      throw FileError(place + ", corner " + std::to_string(i) + ": there is no vertex " +
                      std::to_string(corners[i]) + "; the file has " +
                      std::to_string(mesh.vertices.size()) + ", counted from 0");
}

void check_vertices(const PolygonMesh& mesh, const std::string& file) {
  if (mesh.vertices.empty()) throw FileError(file + ": holds no vertices");
  if (mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw FileError(file + ": holds " + std::to_string(mesh.vertices.size()) +
                    " vertices; at most 2^31 - 1 can be used");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      throw FileError(file + ": vertex " + std::to_string(i) +
                      " (counted from 0) is not finite; a mesh needs finite vertices");
}

}  // namespace

Eigen::Matrix3Xd vertex_matrix(const PolygonMesh& mesh) {
  Eigen::Matrix3Xd vertices(3, static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    vertices.col(static_cast<Eigen::Index>(i)) = mesh.vertices[i];
  return vertices;
}

TriangleMesh triangulate(const PolygonMesh& mesh, const std::string& file) {
  check_vertices(mesh, file);
  std::vector<Eigen::Vector3i> triangles;
  triangles.reserve(mesh.sizes.size());
  std::size_t first = 0;
  for (std::size_t face = 0; face < mesh.sizes.size(); ++face) {
    const Polygon corners(mesh.corners.data() + first, static_cast<std::size_t>(mesh.sizes[face]));
    first += corners.size();
    check_polygon(mesh, file, face, corners);
    clip_ears(mesh, std::vector<int>(corners.begin(), corners.end()), triangles);
  }
  std::erase_if(triangles, [](const Eigen::Vector3i& triangle) {
    return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
  });
  if (triangles.empty())
    throw FileError(file + ": holds " + std::to_string(mesh.vertices.size()) +
                    " vertices but no triangle; a surface is needed");
  TriangleMesh result{vertex_matrix(mesh), {}};
  result.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    result.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return result;
}

}  // namespace palpate::geometry
