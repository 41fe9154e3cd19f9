// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/self_intersections.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <utility>

#include "mesh/exact_predicates.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/parallel_for.h"
#include "query/bounding_tree.h"
#include "query/local_frame.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool same_sign(int a, int b, int c) {
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// A triangle seen along the first axis along which it has an area.
struct FlatTriangle {
  int dropped = -1;  ///< axis; -1 if the corners are collinear
  std::array<Vector2d, 3> corners;

  explicit FlatTriangle(const Corners& triangle) {
    for (int axis = 0; axis < 3 && dropped < 0; ++axis) {
      for (std::size_t k = 0; k < 3; ++k) corners[k] = along(axis, triangle[k]);
      if (orientation(corners[0], corners[1], corners[2]) != 0) dropped = axis;
    }
  }
  static Vector2d along(int axis, const Vector3d& point) {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
  }
};

bool is_in(const FlatTriangle& triangle, const Vector2d& point) {
  const auto& [a, b, c] = triangle.corners;
  return same_sign(orientation(a, b, point), orientation(b, c, point), orientation(c, a, point));
}

bool in_box(const Vector2d& a, const Vector2d& b, const Vector2d& point) {
  return (point.array() >= a.cwiseMin(b).array()).all() &&
         (point.array() <= a.cwiseMax(b).array()).all();
}

bool segments_meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const int to_c = orientation(a, b, c), to_d = orientation(a, b, d);
  const int to_a = orientation(c, d, a), to_b = orientation(c, d, b);
  if (to_c * to_d < 0 && to_a * to_b < 0) return true;
  return (to_c == 0 && in_box(a, b, c)) || (to_d == 0 && in_box(a, b, d)) ||
         (to_a == 0 && in_box(c, d, a)) || (to_b == 0 && in_box(c, d, b));
}

bool meets_in_plane(const Vector3d& start, const Vector3d& end, const Corners& triangle) {
  const FlatTriangle flat(triangle);
  const Vector2d a = FlatTriangle::along(flat.dropped, start);
  const Vector2d b = FlatTriangle::along(flat.dropped, end);
  if (is_in(flat, a)) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (segments_meet(a, b, flat.corners[k], flat.corners[(k + 1) % 3])) return true;
  }
  return false;
}

/// Returns true if a segment meets a triangle or its border. Precondition: it has an area.
bool meets(const Vector3d& start, const Vector3d& end, const Corners& triangle) {
  const auto& [a, b, c] = triangle;
  const int of_start = orientation(a, b, c, start), of_end = orientation(a, b, c, end);
  if (of_start * of_end > 0) return false;
  if (of_start == 0 && of_end == 0) return meets_in_plane(start, end, triangle);
  return same_sign(orientation(start, end, a, b), orientation(start, end, b, c),
                   orientation(start, end, c, a));
}

/// Turns the corners so that the first is the given one.
Corners from(const Corners& triangle, std::size_t first) {
  return {triangle[first], triangle[(first + 1) % 3], triangle[(first + 2) % 3]};
}

/// Returns true if neighbours that share an edge lie in one plane, on the same side of the edge.
bool folded(const Vector3d& a, const Vector3d& b, const Vector3d& one, const Vector3d& other) {
  if (orientation(a, b, one, other) != 0) return false;
  const FlatTriangle flat({a, b, one});
  const auto& [from, to, side] = flat.corners;
  return orientation(from, to, side) ==
         orientation(from, to, FlatTriangle::along(flat.dropped, other));
}

/// Returns true if the triangles meet elsewhere than where they share corners. Precondition: both
/// have an area.
bool intersect(const Corners& one, const Corners& other) {
  std::array<std::size_t, 3> shared_of_one{}, shared_of_other{};
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (one[i] != other[j]) continue;
      shared_of_one[shared] = i;
      shared_of_other[shared++] = j;
    }
  }
  if (shared == 3) return false;
  if (shared == 2) {
    return folded(one[shared_of_one[0]], one[shared_of_one[1]],
                  one[3 - shared_of_one[0] - shared_of_one[1]],
                  other[3 - shared_of_other[0] - shared_of_other[1]]);
  }
  if (shared == 1) {
    // Their intersection ends at a side opposite to the common corner.
    const Corners a = from(one, shared_of_one[0]), b = from(other, shared_of_other[0]);
    return meets(a[1], a[2], b) || meets(b[1], b[2], a);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (meets(one[k], one[(k + 1) % 3], other) || meets(other[k], other[(k + 1) % 3], one))
      return true;
  }
  return false;
}

/// The triangles to be searched, with vertices scaled by a power of two, which is exact.
struct Searched {
  TriangleMesh mesh;
  std::vector<int> original;

  [[nodiscard]] Corners corners(int triangle) const {
    const Eigen::Vector3i of = mesh.triangles.col(triangle);
    return {mesh.vertices.col(of[0]), mesh.vertices.col(of[1]), mesh.vertices.col(of[2])};
  }
};

Searched searched_triangles(const TriangleMesh& mesh) {
  Searched searched;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i of = mesh.triangles.col(t);
    if (of.minCoeff() < 0 || of.maxCoeff() >= mesh.vertices.cols()) continue;
    if (mesh.vertices(Eigen::all, of).allFinite()) searched.original.push_back(t);
  }
  if (searched.original.empty()) return searched;
  searched.mesh.triangles = mesh.triangles(Eigen::all, searched.original);
  searched.mesh.vertices = mesh.vertices;
  searched.mesh.vertices *= local_frame(bounding_box(searched.mesh)).scale;
  std::vector<int> with_area;
  for (int t = 0; t < searched.mesh.triangles.cols(); ++t) {
    if (FlatTriangle(searched.corners(t)).dropped >= 0) with_area.push_back(t);
  }
  searched.mesh.triangles = Eigen::Matrix3Xi(searched.mesh.triangles(Eigen::all, with_area));
  for (std::size_t i = 0; i < with_area.size(); ++i)
    searched.original[i] = searched.original[static_cast<std::size_t>(with_area[i])];
  searched.original.resize(with_area.size());
  return searched;
}

/// Finds the children of a node whose boxes meet that of a triangle.
unsigned overlapping(const TreeNode& node, const Eigen::Array3f& lower,
                     const Eigen::Array3f& upper) {
  unsigned bits = node.children;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    bits &= where_not_above(node.sides[axis][0], BoxLanes::Constant(upper[k]));
    bits &= where_not_above(BoxLanes::Constant(lower[k]), node.sides[axis][1]);
  }
  return bits;
}

}  // namespace

std::vector<int> intersecting_triangles(const TriangleMesh& mesh) {
  const Searched searched = searched_triangles(mesh);
  const auto count = static_cast<int>(searched.original.size());
  if (count == 0) return {};
  const Eigen::Matrix3Xd local =
      local_frame(bounding_box(searched.mesh)).to_local(searched.mesh.vertices);
  const BoundingTree tree = build_tree(local, searched.mesh.triangles, kFloatMargin);
  std::vector<std::atomic<bool>> found(static_cast<std::size_t>(count));
  const auto test = [&](int t, int other) {
    std::atomic<bool>&a = found[static_cast<std::size_t>(t)],
    &b = found[static_cast<std::size_t>(other)];
    if (a.load(std::memory_order_relaxed) && b.load(std::memory_order_relaxed)) return;
    if (!intersect(searched.corners(t), searched.corners(other))) return;
    a.store(true, std::memory_order_relaxed);
    b.store(true, std::memory_order_relaxed);
  };
  parallel_for(count, [&](int t) {
    const Eigen::Matrix3f corners = local(Eigen::all, searched.mesh.triangles.col(t)).cast<float>();
    const Eigen::Array3f lower = corners.rowwise().minCoeff(), upper = corners.rowwise().maxCoeff();
    std::vector<int> to_see = {0};
    while (!to_see.empty()) {
      const TreeNode& node = tree.nodes[static_cast<std::size_t>(to_see.back())];
      to_see.pop_back();
      for (unsigned bits = overlapping(node, lower, upper); bits != 0; bits &= bits - 1) {
        const int child = node.child[static_cast<std::size_t>(std::countr_zero(bits))];
        if (child >= 0) {
          to_see.push_back(child);
          continue;
        }
        for (const int other : tree.packets[static_cast<std::size_t>(~child)].triangle) {
          if (other > t) test(t, other);
        }
      }
    }
  });
  std::vector<int> triangles;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) triangles.push_back(searched.original[i]);
  }
  return triangles;
}

std::vector<MeshDefect> find_all_defects(const TriangleMesh& mesh) {
  std::vector<MeshDefect> defects = find_defects(mesh);
  std::vector<int> intersecting = intersecting_triangles(mesh);
  if (!intersecting.empty()) {
    defects.push_back(
        {.kind = DefectKind::triangle_intersecting, .elements = std::move(intersecting)});
  }
  return defects;
}

}  // namespace palpate::geometry
