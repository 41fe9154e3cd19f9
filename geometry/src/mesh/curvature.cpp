// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/curvature.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <vector>

#include "base/numbers.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

/// Column k is the edge opposite to corner k.
Eigen::Matrix3d edges_of(const TriangleMesh& mesh, const Eigen::Vector3i& corners) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) =
        mesh.vertices.col(corners[(k + 2) % 3]) - mesh.vertices.col(corners[(k + 1) % 3]);
  return edges;
}

/// [1/mm] Tensor in the plane of the triangle that best maps its edges to `turns`, the changes of
/// the normal along them.
Eigen::Matrix3d fit_tensor(const Eigen::Matrix3d& edges, const Eigen::Vector3d& normal,
                           const Eigen::Matrix3d& turns) {
  Eigen::Matrix<double, 3, 2> axes;  // of the plane
  axes.col(0) = edges.col(0).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  Eigen::Matrix<double, 6, 3> equations;
  Eigen::Matrix<double, 6, 1> turned;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d edge = axes.transpose() * edges.col(k);
    equations.row(2 * k) << edge.x(), edge.y(), 0;
    equations.row(2 * k + 1) << 0, edge.x(), edge.y();
    turned.segment<2>(2 * k) = axes.transpose() * turns.col(k);
  }
  const Eigen::Vector3d s = equations.householderQr().solve(turned);
  Eigen::Matrix2d tensor;
  tensor << s[0], s[1], s[1], s[2];
  return axes * tensor * axes.transpose();
}

/// [mm^2] Shares of a triangle's area that belong to its corners: the parts nearest to each corner;
/// in an obtuse triangle half of the area belongs to the obtuse corner.
Eigen::Vector3d corner_areas(const Eigen::Matrix3d& edges) {
  const double twice_area = edges.col(0).cross(edges.col(1)).norm();
  Eigen::Vector3d dot;  // of the edges at each corner; < 0 if the angle is obtuse
  for (int k = 0; k < 3; ++k) dot[k] = -edges.col((k + 1) % 3).dot(edges.col((k + 2) % 3));
  Eigen::Vector3d areas;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const int last = (k + 2) % 3;
    if (dot.minCoeff() < 0) {
      areas[k] = dot[k] < 0 ? twice_area / 4 : twice_area / 8;
    } else {
      areas[k] =
          (dot[next] * edges.col(next).squaredNorm() + dot[last] * edges.col(last).squaredNorm()) /
          (8 * twice_area);
    }
  }
  return areas;
}

/// Vertices at the border or of a triangle without area, where the curvature is unknown.
std::vector<bool> unknown_vertices(const TriangleMesh& mesh, const Eigen::Matrix3Xd& of_triangles) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  std::vector<bool> unknown(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (Eigen::Index t = 0; t < opposite.cols(); ++t) {
    const bool flat = !of_triangles.col(t).allFinite();
    for (int k = 0; k < 3; ++k) {
      if (opposite(k, t) >= 0 && !flat) continue;
      unknown[static_cast<std::size_t>(mesh.triangles(k, t))] = true;
      unknown[static_cast<std::size_t>(mesh.triangles((k + 1) % 3, t))] = true;
    }
  }
  return unknown;
}

}  // namespace

VertexCurvature vertex_curvature(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  const Eigen::Matrix3Xd of_triangles = triangle_normals(mesh);
  const std::vector<bool> unknown = unknown_vertices(mesh, of_triangles);
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  std::vector<Eigen::Matrix3d> tensors(unknown.size(), Eigen::Matrix3d::Zero());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (!of_triangles.col(t).allFinite()) continue;
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    const Eigen::Matrix3d edges = edges_of(mesh, corners);
    Eigen::Matrix3d turns;
    for (int k = 0; k < 3; ++k)
      turns.col(k) = normals.col(corners[(k + 2) % 3]) - normals.col(corners[(k + 1) % 3]);
    const Eigen::Matrix3d tensor = fit_tensor(edges, of_triangles.col(t), turns);
    const Eigen::Vector3d areas = corner_areas(edges);
    for (int k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(corners[k]);
      if (unknown[vertex]) continue;
      const Eigen::Matrix3d turn =
          Eigen::Quaterniond::FromTwoVectors(of_triangles.col(t), normals.col(corners[k]))
              .toRotationMatrix();
      tensors[vertex] += areas[k] * (turn * tensor * turn.transpose());
      area[corners[k]] += areas[k];
    }
  }
  VertexCurvature result{Eigen::VectorXd::Constant(area.size(), kNan),
                         Eigen::VectorXd::Constant(area.size(), kNan)};
  for (Eigen::Index i = 0; i < area.size(); ++i) {
    if (!(area[i] > 0)) continue;
    const Eigen::Matrix3d tensor = tensors[static_cast<std::size_t>(i)] / area[i];
    const double trace = tensor.trace();
    result.mean[i] = trace / 2;
    // One eigenvalue is 0, along the normal.
    result.gaussian[i] = (trace * trace - tensor.squaredNorm()) / 2;
  }
  return result;
}

}  // namespace palpate::geometry
