// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/curvature.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What the triangles around each vertex add up to.
struct Sums {
  Eigen::Matrix3Xd cotangent_edges;  ///< [mm] sum of (cot a + cot b) (x_i - x_j)
  Eigen::VectorXd angle;             ///< [rad]
  Eigen::VectorXd area;              ///< [mm^2] mixed Voronoi area
};

/// Adds a triangle that has an area to the sums of its corners.
void add_triangle(const TriangleMesh& mesh, const Eigen::Vector3i& corners, Sums& sums) {
  Eigen::Matrix3d edge;  // edge k is opposite to corner k
  for (int k = 0; k < 3; ++k)
    edge.col(k) = mesh.vertices.col(corners[(k + 2) % 3]) - mesh.vertices.col(corners[(k + 1) % 3]);
  const double twice_area = edge.col(0).cross(edge.col(1)).norm();
  Eigen::Vector3d dot;  // > 0: the angle is acute
  for (int k = 0; k < 3; ++k) dot[k] = -edge.col((k + 1) % 3).dot(edge.col((k + 2) % 3));
  const Eigen::Vector3d cotangent = dot / twice_area;
  const bool obtuse = dot.minCoeff() < 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const int last = (k + 2) % 3;
    const int i = corners[k];
    sums.cotangent_edges.col(i) +=
        cotangent[next] * edge.col(next) - cotangent[last] * edge.col(last);
    sums.angle[i] += std::atan2(twice_area, dot[k]);
    sums.area[i] += !obtuse ? (cotangent[next] * edge.col(next).squaredNorm() +
                               cotangent[last] * edge.col(last).squaredNorm()) /
                                  8
                    : dot[k] < 0 ? twice_area / 4
                                 : twice_area / 8;
  }
}

}  // namespace

VertexCurvature vertex_curvature(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  const Eigen::Index count = mesh.vertices.cols();
  Sums sums{Eigen::Matrix3Xd::Zero(3, count), Eigen::VectorXd::Zero(count),
            Eigen::VectorXd::Zero(count)};
  const Eigen::Matrix3Xd of_triangles = triangle_normals(mesh);
  const auto make_unknown = [&](int vertex) { sums.area[vertex] = kNan; };
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    if (of_triangles.col(t).allFinite()) {
      add_triangle(mesh, corners, sums);
    } else {
      std::for_each(corners.begin(), corners.end(), make_unknown);
    }
    for (int k = 0; k < 3; ++k) {
      if (opposite(k, t) >= 0) continue;
      make_unknown(corners[k]);
      make_unknown(corners[(k + 1) % 3]);
    }
  }
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  const Eigen::ArrayXd area = (sums.area.array() > 0).select(sums.area.array(), kNan);
  const Eigen::ArrayXd along_normal =
      normals.cwiseProduct(sums.cotangent_edges).colwise().sum().transpose();
  return {.mean = along_normal / (4 * area),
          .gaussian = (2 * std::numbers::pi - sums.angle.array()) / area};
}

}  // namespace palpate::geometry
