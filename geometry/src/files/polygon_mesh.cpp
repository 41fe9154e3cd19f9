// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/polygon_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <variant>

#include "palpate/core/error.h"

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
  // After clipping an ear continue with the next corner but one: a convex polygon then needs one
  // round, and its triangles are less slender than those of a fan.
  std::size_t corner = 0;
  std::size_t refused = 0;
  // Corners whose triangles are known to be no ears: in a simple polygon that can only change at
  // the neighbours of a corner that was clipped. So the time grows with the square of the corners.
  std::vector<char> is_refused(polygon.size(), 0);
  bool has_skipped = false;  // in this round
  while (polygon.size() > 3) {
    const std::size_t size = polygon.size();
    corner %= size;
    const std::size_t tip = (corner + 1) % size, after = (corner + 2) % size;
    const Eigen::Vector3i triangle(polygon[corner], polygon[tip], polygon[after]);
    if (refused == size && has_skipped) {  // the polygon is not simple: look at all of them again
      std::ranges::fill(is_refused, 0);
      refused = 0;
      has_skipped = false;
    }
    // A self-intersecting or degenerate polygon may have no ear; then any corner is clipped.
    if (refused < size && (is_refused[tip] != 0 || !is_ear(mesh, normal, polygon, triangle))) {
      has_skipped = has_skipped || is_refused[tip] != 0;
      is_refused[tip] = 1;
      ++corner;
      ++refused;
      continue;
    }
    triangles.push_back(triangle);
    is_refused[corner] = is_refused[after] = 0;
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(tip));
    is_refused.erase(is_refused.begin() + static_cast<std::ptrdiff_t>(tip));
    ++corner;
    refused = 0;
    has_skipped = false;
  }
  triangles.emplace_back(polygon[0], polygon[1], polygon[2]);
}

void check_polygon(const PolygonMesh& mesh, const std::string& file, std::size_t face,
                   Polygon corners) {
  const auto place = [&] { return file + ": face " + std::to_string(face); };
  if (corners.size() < 3)
    throw FileError(place() + " has " + std::to_string(corners.size()) +
                    " corners; at least 3 are needed");
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (corners[i] < 0 || corners[i] >= static_cast<std::int64_t>(mesh.vertices.size()))
      throw FileError(place() + ", corner " + std::to_string(i) + ": there is no vertex " +
                      std::to_string(corners[i]) + "; the file has " +
                      std::to_string(mesh.vertices.size()) + ", counted from 0");
}

/// Fan of triangles that represents a defective polygon, which cannot be cut into ears.
void keep_broken(Polygon corners, std::vector<Eigen::Vector3i>& triangles) {
  const auto corner = [&](std::size_t i) {
    const std::int64_t index = corners[std::min(i, corners.size() - 1)];
    return index == static_cast<int>(index) ? static_cast<int>(index) : -1;
  };
  for (std::size_t i = 1; i == 1 || i + 1 < corners.size(); ++i)
    triangles.emplace_back(corner(0), corner(i), corner(i + 1));
}

bool names_vertices(const PolygonMesh& mesh, Polygon corners) {
  return std::all_of(corners.begin(), corners.end(), [&](std::int64_t corner) {
    return corner >= 0 && corner < static_cast<std::int64_t>(mesh.vertices.size());
  });
}

void check_count(const PolygonMesh& mesh, const std::string& file) {
  if (mesh.vertices.empty()) throw FileError(file + ": holds no vertices");
  if (mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw FileError(file + ": holds " + std::to_string(mesh.vertices.size()) +
                    " vertices; at most 2^31 - 1 can be used");
}

void check_finite(const PolygonMesh& mesh, const std::string& file) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      throw FileError(file + ": vertex " + std::to_string(i) +
                      " (counted from 0) is not finite; a mesh needs finite vertices");
}

bool uses_a_vertex_twice(const Eigen::Vector3i& triangle) {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

/// Selects the values of `elements` from an attribute.
Attribute of_elements(const Attribute& attribute, const std::vector<std::size_t>& elements) {
  const std::vector<int>& sizes = attribute.list_sizes;
  std::vector<std::ptrdiff_t> first{0};  // number of each list
  for (const int size : sizes) first.push_back(first.back() + size);
  Attribute result{attribute.name, {}, {}};
  for (const std::size_t element : elements)
    if (!sizes.empty()) result.list_sizes.push_back(sizes[element]);
  std::visit(
      [&](const auto& numbers) {
        std::decay_t<decltype(numbers)> chosen;
        for (const std::size_t element : elements) {
          if (sizes.empty()) {
            chosen.push_back(numbers[element]);
          } else {
            chosen.insert(chosen.end(), numbers.begin() + first[element],
                          numbers.begin() + first[element + 1]);
          }
        }
        result.values = std::move(chosen);
      },
      attribute.values);
  return result;
}

/// The places of the triangles' corners in the texture, from those of the corners of polygons. None
/// if the list does not fit the polygon.
Attribute texture_of_corners(const Attribute& attribute, const PolygonMesh& mesh,
                             const std::vector<Eigen::Vector3i>& triangles,
                             const std::vector<std::size_t>& face_of) {
  std::vector<std::ptrdiff_t> first_corner{0}, first_number{0};
  for (std::size_t face = 0; face < mesh.sizes.size(); ++face) {
    first_corner.push_back(first_corner.back() + mesh.sizes[face]);
    first_number.push_back(first_number.back() + attribute.list_sizes[face]);
  }
  Attribute result{attribute.name, {}, {}};
  std::visit(
      [&](const auto& numbers) {
        std::decay_t<decltype(numbers)> chosen;
        for (std::size_t t = 0; t < triangles.size(); ++t) {
          const std::size_t face = face_of[t];
          const bool fits =
              mesh.sizes[face] >= 3 && attribute.list_sizes[face] == 2 * mesh.sizes[face];
          result.list_sizes.push_back(fits ? 6 : 0);
          const auto begin = mesh.corners.begin() + first_corner[face];
          const auto end = mesh.corners.begin() + first_corner[face + 1];
          for (int k = 0; fits && k < 3; ++k) {
            const auto corner = std::find(begin, end, triangles[t][k]);
            // A corner that is no vertex is not found; the triangle is a defect anyway.
            const auto place = corner == end ? 0 : corner - begin;
            const auto number = numbers.begin() + first_number[face] + 2 * place;
            chosen.insert(chosen.end(), number, number + 2);
          }
        }
        result.values = std::move(chosen);
      },
      attribute.values);
  return result;
}

std::uint64_t hash_of(const Eigen::Vector3d& place) {
  std::uint64_t hash = 0;
  // + 0.0 because both zeros are equal and must hash alike. The multiplier is 2^64 / golden ratio.
  for (const double x : place)
    hash = (std::rotl(hash, 27) ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15U;
  return hash ^ (hash >> 32);
}

/// Numbers different places in the order in which they come. A table without links: places with
/// equal hashes are in the next free rows.
class PlaceNumbers {
 public:
  explicit PlaceNumbers(std::size_t most_places)
      : rows_(std::bit_ceil(2 * most_places + 1), kFree) {}

  std::int64_t number(const Eigen::Vector3d& place) {
    std::size_t row = hash_of(place) & (rows_.size() - 1);
    for (; rows_[row] != kFree; row = (row + 1) & (rows_.size() - 1))
      if (places_[static_cast<std::size_t>(rows_[row])] == place) return rows_[row];
    rows_[row] = static_cast<std::int32_t>(places_.size());
    places_.push_back(place);
    return rows_[row];
  }

  [[nodiscard]] std::vector<Eigen::Vector3d>& places() { return places_; }

 private:
  static constexpr std::int32_t kFree = -1;
  std::vector<std::int32_t> rows_;
  std::vector<Eigen::Vector3d> places_;
};

}  // namespace

Eigen::Matrix3Xd vertex_matrix(const PolygonMesh& mesh) {
  Eigen::Matrix3Xd vertices(3, static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    vertices.col(static_cast<Eigen::Index>(i)) = mesh.vertices[i];
  return vertices;
}

MeshFile triangulate(PolygonMesh mesh, const std::string& file, bool keep_defects) {
  check_count(mesh, file);
  if (!keep_defects) check_finite(mesh, file);
  std::vector<Eigen::Vector3i> triangles;
  triangles.reserve(mesh.sizes.size());
  std::vector<std::size_t> face_of;  // of each triangle
  face_of.reserve(mesh.sizes.size());
  std::size_t first = 0;
  for (std::size_t face = 0; face < mesh.sizes.size(); ++face) {
    const Polygon corners(mesh.corners.data() + first, static_cast<std::size_t>(mesh.sizes[face]));
    first += corners.size();
    if (!keep_defects) check_polygon(mesh, file, face, corners);
    if (corners.size() == 3 && names_vertices(mesh, corners)) {
      triangles.emplace_back(static_cast<int>(corners[0]), static_cast<int>(corners[1]),
                             static_cast<int>(corners[2]));
    } else if (corners.size() > 3 && names_vertices(mesh, corners)) {
      clip_ears(mesh, std::vector<int>(corners.begin(), corners.end()), triangles);
    } else if (!corners.empty()) {
      keep_broken(corners, triangles);
    }
    if (!keep_defects) {
      const auto of_face = triangles.begin() + static_cast<std::ptrdiff_t>(face_of.size());
      triangles.erase(std::remove_if(of_face, triangles.end(), uses_a_vertex_twice),
                      triangles.end());
    }
    face_of.resize(triangles.size(), face);
  }
  if (triangles.empty())
    throw FileError(file + ": holds " + std::to_string(mesh.vertices.size()) +
                    " vertices but no triangle; a surface is needed");
  MeshFile result;
  result.mesh.vertices = vertex_matrix(mesh);
  result.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    result.mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  result.vertex_attributes = std::move(mesh.vertex_attributes);
  result.triangle_attributes = std::move(mesh.face_attributes);
  result.material_files = std::move(mesh.material_files);
  result.materials = std::move(mesh.materials);
  // If there is one triangle per face, in order, the attributes stay as they are. Equal counts are
  // not enough: one face may give no triangle and another one two.
  if (triangles.size() == mesh.sizes.size() &&
      std::adjacent_find(face_of.begin(), face_of.end()) == face_of.end())
    return result;
  for (Attribute& attribute : result.triangle_attributes) {
    const bool is_texture = attribute.name == "texcoord" && !attribute.list_sizes.empty();
    attribute = is_texture ? texture_of_corners(attribute, mesh, triangles, face_of)
                           : of_elements(attribute, face_of);
  }
  return result;
}

void join_corners(PolygonMesh& mesh) {
  if (mesh.vertices.size() != mesh.corners.size()) return;
  // The check that follows reports this.
  if (mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return;
  PlaceNumbers numbers(mesh.vertices.size());
  std::vector<std::int64_t> joined;
  joined.reserve(mesh.corners.size());
  for (const std::int64_t corner : mesh.corners) {
    if (corner < 0 || corner >= static_cast<std::int64_t>(mesh.vertices.size())) return;
    const Eigen::Vector3d& vertex = mesh.vertices[static_cast<std::size_t>(corner)];
    // NaN equals nothing; the check that follows reports the vertex.
    if (!vertex.allFinite()) return;
    joined.push_back(numbers.number(vertex));
  }
  if (numbers.places().size() == mesh.vertices.size()) return;  // no two vertices coincide
  mesh.vertices = std::move(numbers.places());
  mesh.corners = std::move(joined);
  mesh.vertex_attributes.clear();
}

}  // namespace palpate::geometry
