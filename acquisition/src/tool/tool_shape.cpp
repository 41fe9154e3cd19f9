// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/tool_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/core/require.h"

namespace palpate::acquisition {
namespace {

using Eigen::Vector3d;

constexpr int kAround = 32;  // vertices of a ring
constexpr int kRings = 9;    // from the tip to the widest ring of the ball

void check_shape(const ToolShape& shape) {
  require("ToolShape::radius", shape.radius, above(0).finite(), "mm");
  require("ToolShape::shaft", shape.shaft, above(0).finite(), "mm");
}

Vector3d centre_of_ball(const ToolShape& shape, const ToolPose& pose) {
  return pose.tip - shape.radius * pose.inward;
}

}  // namespace

geometry::TriangleMesh tool_mesh(const ToolShape& shape, const ToolPose& pose) {
  check_shape(shape);
  const Vector3d centre = centre_of_ball(shape, pose);
  const Vector3d x = pose.inward.unitOrthogonal(), y = pose.inward.cross(x);
  // The tip, rings around the ball, one at the end of the shaft, and the middle of that end.
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, 2 + (kRings + 1) * kAround);
  mesh.triangles.resize(3, 2 * (kRings + 1) * kAround);
  mesh.vertices.col(0) = pose.tip;
  Eigen::Index vertex = 1;
  const auto add_ring = [&](double radius, double along) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      mesh.vertices.col(vertex++) =
          centre + along * pose.inward + radius * (std::cos(angle) * x + std::sin(angle) * y);
    }
  };
  for (int ring = 1; ring <= kRings; ++ring) {
    const double angle = std::numbers::pi / 2 * ring / kRings;
    add_ring(shape.radius * std::sin(angle), shape.radius * std::cos(angle));
  }
  add_ring(shape.radius, -shape.shaft);
  const int end = static_cast<int>(vertex);
  mesh.vertices.col(vertex) = centre - shape.shaft * pose.inward;
  Eigen::Index triangle = 0;
  for (int i = 0; i < kAround; ++i) {
    const int next = (i + 1) % kAround;
    mesh.triangles.col(triangle++) << 0, 1 + i, 1 + next;
    for (int ring = 0; ring < kRings; ++ring) {
      const int here = 1 + ring * kAround, there = here + kAround;
      mesh.triangles.col(triangle++) << here + i, there + next, here + next;
      mesh.triangles.col(triangle++) << here + i, there + i, there + next;
    }
    const int last = 1 + kRings * kAround;
    mesh.triangles.col(triangle++) << last + i, end, last + next;
  }
  return mesh;
}

geometry::PixelMask hidden_by_tool(const Eigen::Matrix2Xd& rays, Eigen::Index rows,
                                   const ToolShape& shape, const ToolPose& pose, double margin) {
  check_shape(shape);
  require("hidden_by_tool: margin", margin, at_least(0).finite(), "mm");
  const Vector3d from = centre_of_ball(shape, pose), way = -shape.shaft * pose.inward;
  const double reach = shape.radius + margin;
  const Eigen::Index columns = rays.cols() / rows;
  geometry::PixelMask hidden(rows, columns);
  for (Eigen::Index i = 0; i < rays.cols(); ++i) {
    const Vector3d ray = rays.col(i).homogeneous().normalized();
    // Across the ray, where the shaft is nearest to it.
    const Vector3d from_across = from - ray * ray.dot(from), way_across = way - ray * ray.dot(way);
    const double length = way_across.squaredNorm();
    const double part =
        length > 0 ? std::clamp(-from_across.dot(way_across) / length, 0.0, 1.0) : 0.0;
    hidden(i / columns, i % columns) = (from_across + part * way_across).norm() <= reach;
  }
  return hidden;
}

}  // namespace palpate::acquisition
