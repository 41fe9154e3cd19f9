// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/triangle_packet.h"

#include <cmath>
#include <cstddef>

namespace palpate::geometry {
namespace {

using Vector3Lanes = std::array<Lanes, 3>;

// Always inlined; otherwise the lanes pass through memory.
[[gnu::always_inline]] inline Vector3Lanes operator-(const Vector3Lanes& a, const Vector3Lanes& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[gnu::always_inline]] inline Lanes dot(const Vector3Lanes& a, const Vector3Lanes& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[gnu::always_inline]] inline Vector3Lanes cross(const Vector3Lanes& a, const Vector3Lanes& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Smaller squares are not used as divisors: edges and areas of that size are lost in rounding.
constexpr float kLeastFloat = std::numeric_limits<float>::min();

}  // namespace

void set_corners(TrianglePacket& packet, const Eigen::Matrix3Xd& vertices,
                 const Eigen::Matrix3Xi& triangles) {
  for (int lane = 0; lane < TrianglePacket::kSize; ++lane) {
    const int named = packet.triangle[static_cast<std::size_t>(lane)];
    const int triangle = named < 0 ? packet.triangle[0] : named;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = vertices.col(triangles(static_cast<int>(k), triangle));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        packet.corner[k][axis][lane] = static_cast<float>(vertex[static_cast<int>(axis)]);
      }
    }
  }
}

// Edge distances follow from scalar products of two edges and the offset from their common corner,
// minus the possible rounding error of a small difference of large squares. The plane also counts
// slightly outside the triangle, since it is never farther away than the triangle.
Lanes squared_distances(const Eigen::Vector3f& point, const TrianglePacket& packet) {
  constexpr float kRounding = 16 * std::numeric_limits<float>::epsilon();
  constexpr float kOutside = 1e-3F;  // fraction of the triangle's heights
  constexpr float kFar = 1e30F;
  const auto& [a, b, c] = packet.corner;
  const Vector3Lanes p = {Lanes::Constant(point[0]), Lanes::Constant(point[1]),
                          Lanes::Constant(point[2])};
  const Vector3Lanes ab = b - a, ac = c - a, ap = p - a;
  const Lanes bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  const Lanes bp = dot(ab, ap), cp = dot(ac, ap), pp = dot(ap, ap);

  // The edge from a corner to which the point has the offset o: o.o - 2 s (o.e) + s^2 (e.e).
  const Lanes s_ab = (bp / bb.max(kLeastFloat)).max(0.0F).min(1.0F);
  const Lanes s_ac = (cp / cc.max(kLeastFloat)).max(0.0F).min(1.0F);
  const Lanes along_bc = cp - bp - bc + bb, square_bc = bb + cc - 2.0F * bc;
  const Lanes s_bc = (along_bc / square_bc.max(kLeastFloat)).max(0.0F).min(1.0F);
  const Lanes to_ab = pp - s_ab * (2.0F * bp - s_ab * bb);
  const Lanes to_ac = pp - s_ac * (2.0F * cp - s_ac * cc);
  const Lanes to_bc = pp - 2.0F * bp + bb - s_bc * (2.0F * along_bc - s_bc * square_bc);
  const Lanes scale = pp + bb + cc;
  const Lanes to_edges = to_ab.min(to_ac).min(to_bc) - kRounding * scale;

  const Vector3Lanes normal = cross(ab, ac);
  const Lanes height = dot(normal, ap), area = dot(normal, normal);
  const Lanes inverse = area.max(kLeastFloat).inverse();
  const Lanes v = dot(cross(ap, ac), normal) * inverse, w = dot(cross(ab, ap), normal) * inverse;
  const Lanes outside = (-v).max(-w).max(v + w - 1.0F) - kOutside;
  const Lanes to_plane = height * height * inverse + outside.max(0.0F) * kFar;
  return to_plane.min(to_edges);
}

DoubleLanes squared_distances(const Eigen::Vector3d& point, const TrianglePacket& packet) {
  // Largest move of a corner in [-1, 1] when it is rounded to float.
  constexpr double kRounding = static_cast<double>(std::numeric_limits<float>::epsilon()) / 2;
  const auto& [a, b, c] = packet.corner;
  DoubleLanes squared = DoubleLanes::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double p = point[static_cast<int>(axis)];
    const DoubleLanes lower = a[axis].min(b[axis]).min(c[axis]).cast<double>();
    const DoubleLanes upper = a[axis].max(b[axis]).max(c[axis]).cast<double>();
    squared += ((lower - p).max(p - upper) - kRounding).max(0.0).square();
  }
  return squared;
}

SegmentLanes::SegmentLanes(const Eigen::Vector3d& start, const ShearedSegment& segment,
                           double margin)
    : axis_(segment.axis()),
      start_(static_cast<float>(start[axis_[0]]), static_cast<float>(start[axis_[1]]),
             static_cast<float>(start[axis_[2]])),
      shear_0_(static_cast<float>(segment.shear_0())),
      shear_1_(static_cast<float>(segment.shear_1())),
      // Without a branch, which a processor could only guess.
      sign_(static_cast<float>(std::copysign(1.0, segment.length()))),
      margin_(static_cast<float>(margin)) {}

// The three areas of Woop, Benthin and Wald have the same sign where the segment meets the
// triangle. The error of a sheared coordinate is at most the margin, so the error of an area, a
// difference of two products of coordinates, is at most the margin times the coordinates; twice
// that with the rounding of the products.
Passing SegmentLanes::pass(const TrianglePacket& packet) const {
  std::array<Lanes, 3> x, y, z;
  const auto axis = [&](std::size_t k) { return static_cast<std::size_t>(axis_[k]); };
  for (std::size_t k = 0; k < 3; ++k) {
    z[k] = packet.corner[k][axis(2)] - start_[2];
    x[k] = packet.corner[k][axis(0)] - start_[0] - shear_0_ * z[k];
    y[k] = packet.corner[k][axis(1)] - start_[1] - shear_1_ * z[k];
  }
  const Lanes a = x[1] * y[2] - y[1] * x[2];
  const Lanes b = x[2] * y[0] - y[2] * x[0];
  const Lanes c = x[0] * y[1] - y[0] * x[1];
  const Lanes size =
      x[0].abs() + x[1].abs() + x[2].abs() + y[0].abs() + y[1].abs() + y[2].abs() + margin_;
  const Lanes lowest = a.min(b).min(c), highest = a.max(b).max(c);
  const Lanes along_0 = sign_ * z[0], along_1 = sign_ * z[1], along_2 = sign_ * z[2];
  return {.miss = highest.min(-lowest) - 2 * margin_ * size,
          .begin = along_0.min(along_1).min(along_2),
          .end = along_0.max(along_1).max(along_2)};
}

}  // namespace palpate::geometry
