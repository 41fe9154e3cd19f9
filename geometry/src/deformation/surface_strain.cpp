// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_strain.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Neighbours on a line do not determine a map: the smaller eigenvalue of their spread must be
// larger than this, relative to the larger one.
constexpr double kSpread = 1e-6;

using Tangents = Eigen::Matrix<double, 3, 2>;

// Two unit vectors across a normal.
Tangents tangents(const Vector3d& normal) {
  Tangents axes;
  axes.col(0) = normal.unitOrthogonal();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

// A place in the tangent plane, as far from the vertex as it is in space.
Vector2d flattened(const Tangents& axes, const Vector3d& offset) {
  const Vector2d place = axes.transpose() * offset;
  const double length = place.norm();
  return length > 0 ? Vector2d(place * (offset.norm() / length)) : place;
}

std::vector<std::vector<int>> edge_neighbours(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(mesh.vertices.cols()));
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      // A neighbour inside the surface occurs twice, one on the border once.
      neighbours[static_cast<std::size_t>(corners[k])].push_back(corners[(k + 1) % 3]);
      neighbours[static_cast<std::size_t>(corners[k])].push_back(corners[(k + 2) % 3]);
    }
  }
  for (std::vector<int>& of : neighbours) {
    std::ranges::sort(of);
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }
  return neighbours;
}

// The vertices around one, within the radius or on an edge with it.
std::vector<int> around(const TriangleMesh& mesh, const std::vector<std::vector<int>>& edges,
                        int vertex, double radius, std::vector<int>& seen_from) {
  std::vector<int> found{vertex};
  seen_from[static_cast<std::size_t>(vertex)] = vertex;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const int other : edges[static_cast<std::size_t>(found[i])]) {
      int& seen = seen_from[static_cast<std::size_t>(other)];
      if (seen == vertex) continue;
      seen = vertex;
      const double distance = (mesh.vertices.col(other) - mesh.vertices.col(vertex)).norm();
      if (i == 0 || distance <= radius) found.push_back(other);
    }
  }
  found.erase(found.begin());
  return found;
}

}  // namespace

SurfaceStrain surface_strain(const TriangleMesh& reference, const Eigen::Matrix3Xd& vertices,
                             double radius) {
  check_mesh(reference, "surface_strain(): reference");
  const Eigen::Index count = reference.vertices.cols();
  if (vertices.cols() != count) {
    throw InvalidInput("surface_strain(): vertices has " + std::to_string(vertices.cols()) +
                       " columns; the reference has " + std::to_string(count) + " vertices");
  }
  if (!vertices.allFinite())
    throw InvalidInput("surface_strain(): vertices has a number that is not finite");
  require("surface_strain(): radius", radius, at_least(0).finite(), "mm");
  const TriangleMesh moved{.vertices = vertices, .triangles = reference.triangles};
  const Eigen::Matrix3Xd before = vertex_normals(reference), after = vertex_normals(moved);
  const std::vector<std::vector<int>> edges = edge_neighbours(reference);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  SurfaceStrain result{.largest = Eigen::VectorXd::Constant(count, kUnknown),
                       .smallest = Eigen::VectorXd::Constant(count, kUnknown),
                       .direction = Eigen::Matrix3Xd::Constant(3, count, kUnknown),
                       .area = Eigen::VectorXd::Constant(count, kUnknown)};
  constexpr std::ptrdiff_t kGrain = 2000;
  parallel_ranges(count, kGrain, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::vector<int> seen_from(static_cast<std::size_t>(count), -1);
    for (auto v = static_cast<Eigen::Index>(begin); v < end; ++v) {
      if (!before.col(v).allFinite() || !after.col(v).allFinite()) continue;
      const Tangents from = tangents(before.col(v)), to = tangents(after.col(v));
      Matrix2d spread = Matrix2d::Zero(), moved_spread = Matrix2d::Zero();
      for (const int other : around(reference, edges, static_cast<int>(v), radius, seen_from)) {
        const Vector2d was =
            flattened(from, reference.vertices.col(other) - reference.vertices.col(v));
        spread += was * was.transpose();
        moved_spread += flattened(to, vertices.col(other) - vertices.col(v)) * was.transpose();
      }
      const double mean = spread.trace() / 2;
      if (!(spread.determinant() > kSpread * mean * mean)) continue;
      const Matrix2d map = moved_spread * spread.inverse();
      const Eigen::SelfAdjointEigenSolver<Matrix2d> squares(map * map.transpose());
      result.smallest[v] = std::sqrt(std::max(0.0, squares.eigenvalues()[0]));
      result.largest[v] = std::sqrt(std::max(0.0, squares.eigenvalues()[1]));
      result.area[v] = result.largest[v] * result.smallest[v];
      result.direction.col(v) = to * squares.eigenvectors().col(1);
    }
  });
  return result;
}

}  // namespace palpate::geometry
