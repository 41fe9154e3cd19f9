// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_primitives.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::geometry {
namespace {

/// A triangle has an area iff |ab x ac| > kMinSine |ab| |ac|; below this, rounding determines the
/// normal.
constexpr double kMinSine = 8 * std::numeric_limits<double>::epsilon();

/// Nearest point of the edge from corner `i` to the next one.
Nearest nearest_on_edge(const Eigen::Vector3d& point, const Corners& corners, int i) {
  const int j = (i + 1) % 3;
  const Eigen::Vector3d edge = corners[static_cast<size_t>(j)] - corners[static_cast<size_t>(i)];
  const Eigen::Vector3d offset = point - corners[static_cast<size_t>(i)];
  const double length_squared = edge.squaredNorm();
  const double s = length_squared > 0 ? std::clamp(edge.dot(offset) / length_squared, 0.0, 1.0) : 0;
  Nearest nearest;
  nearest.barycentric[i] = 1 - s;
  nearest.barycentric[j] = s;
  // Interpolate from the nearer end, which is exact at both ends, so that triangles that share a
  // vertex give the same point.
  nearest.squared_distance =
      s < 0.5 ? (offset - s * edge).squaredNorm()
              : (point - corners[static_cast<size_t>(j)] + (1 - s) * edge).squaredNorm();
  return nearest;
}

/// a0 b1 - a1 b0 with one rounding and the exact sign (Kahan), unless products are below 1e-290.
double exact_cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double left = a[0] * b[1], right = a[1] * b[0];
  const double left_error = std::fma(a[0], b[1], -left), right_error = std::fma(a[1], b[0], -right);
  return (left - right) + (left_error - right_error);
}

/// The side of the edge from a to b, seen along axis 2, on which the origin is, once it is moved by
/// d on axis 0 and d^2 on axis 1 with an infinitesimal d (Edelsbrunner and Muecke 1990): 1, -1, or
/// 0 if the edge is a point.
int side_of_origin(double cross, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const auto sign = [](double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  if (cross != 0) return sign(cross);
  return a[1] != b[1] ? sign(a[1] - b[1]) : sign(b[0] - a[0]);
}

/// Foot of the perpendicular on a triangle's plane.
struct PlaneFoot {
  Nearest nearest;              ///< at infinity if it is outside the triangle
  bool is_well_inside = false;  ///< no edge can be nearer
};

PlaneFoot foot_on_plane(const Eigen::Vector3d& point, const Corners& corners) {
  // Rounding moves the foot by less than kInside of the triangle's heights unless the triangle is a
  // needle, with a sine less than the root of kFlat.
  constexpr double kInside = 1e-9;
  constexpr double kFlat = 1e-8;
  const Eigen::Vector3d ab = corners[1] - corners[0];
  const Eigen::Vector3d ac = corners[2] - corners[0];
  const Eigen::Vector3d offset = point - corners[0];
  const Eigen::Vector3d normal = ab.cross(ac);
  const double area_squared = normal.squaredNorm();
  PlaneFoot foot;
  if (!(area_squared > 0)) return foot;
  const double v = offset.cross(ac).dot(normal) / area_squared;
  const double w = ab.cross(offset).dot(normal) / area_squared;
  if (!(v >= 0 && w >= 0 && v + w <= 1)) return foot;
  foot.nearest.barycentric = Eigen::Vector3d(1 - v - w, v, w);
  foot.nearest.squared_distance = (offset - v * ab - w * ac).squaredNorm();
  foot.is_well_inside = v > kInside && w > kInside && v + w < 1 - kInside &&
                        area_squared > kFlat * ab.squaredNorm() * ac.squaredNorm();
  return foot;
}

}  // namespace

Eigen::Vector3d area_vector(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& triangle) {
  const Eigen::Vector3d a = vertices.col(triangle[0]);
  const Eigen::Vector3d ab = vertices.col(triangle[1]) - a;
  const Eigen::Vector3d ac = vertices.col(triangle[2]) - a;
  return ab.cross(ac) / 2;
}

Eigen::Vector3d unit_normal(const Corners& corners) {
  const auto& [a, b, c] = corners;
  // Lengths in units of the longest coordinate difference, so that neither huge nor tiny triangles
  // over- or underflow.
  const double length = std::max((b - a).cwiseAbs().maxCoeff(), (c - a).cwiseAbs().maxCoeff());
  const Eigen::Vector3d ab = (b - a) / length;
  const Eigen::Vector3d ac = (c - a) / length;
  const Eigen::Vector3d normal = ab.cross(ac);
  if (normal.norm() > kMinSine * ab.norm() * ac.norm()) return normal.normalized();
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

// All four candidates are compared by the distance to the point that their barycentric coordinates
// give, so that a needle, whose normal is mostly rounding error, still has a valid nearest point.
Nearest nearest_on_triangle(const Eigen::Vector3d& point, const Corners& corners) {
  const PlaneFoot foot = foot_on_plane(point, corners);
  if (foot.is_well_inside) return foot.nearest;
  Nearest best = foot.nearest;
  for (int i = 0; i < 3; ++i) {
    const Nearest candidate = nearest_on_edge(point, corners, i);
    if (candidate.squared_distance < best.squared_distance) best = candidate;
  }
  return best;
}

Eigen::Vector3d ShearedSegment::direction() const {
  const double sign = length_ < 0 ? -1 : 1;
  Eigen::Vector3d direction;
  direction[axis_[0]] = sign * shear_0_;
  direction[axis_[1]] = sign * shear_1_;
  direction[axis_[2]] = sign;
  return direction;
}

Crossing cross_triangle(const ShearedSegment& segment, const Corners& corners) {
  const Eigen::Vector3d a = segment.shear(corners[0]);
  const Eigen::Vector3d b = segment.shear(corners[1]);
  const Eigen::Vector3d c = segment.shear(corners[2]);
  const Eigen::Vector3d areas(b[0] * c[1] - b[1] * c[0], c[0] * a[1] - c[1] * a[0],
                              a[0] * b[1] - a[1] * b[0]);
  Crossing crossing;
  const bool inside = (areas.array() >= 0).all() || (areas.array() <= 0).all();
  const double total = areas.sum();
  if (!inside || total == 0) return crossing;
  const Eigen::Vector3d barycentric = areas / total;
  const double fraction = barycentric.dot(Eigen::Vector3d(a[2], b[2], c[2])) / segment.length();
  if (!(fraction >= 0 && fraction <= 1)) return crossing;
  crossing.fraction = fraction;
  crossing.barycentric = barycentric;
  return crossing;
}

Crossing cross_triangle_beside_edges(const ShearedSegment& segment, const Corners& corners) {
  const Eigen::Vector3d a = segment.shear(corners[0]);
  const Eigen::Vector3d b = segment.shear(corners[1]);
  const Eigen::Vector3d c = segment.shear(corners[2]);
  const Eigen::Vector3d areas(exact_cross(b, c), exact_cross(c, a), exact_cross(a, b));
  Crossing crossing;
  const int side = side_of_origin(areas[0], b, c);
  if (side == 0 || side != side_of_origin(areas[1], c, a) ||
      side != side_of_origin(areas[2], a, b)) {
    return crossing;
  }
  const double total = areas.sum();
  if (total == 0) return crossing;  // smaller than the smallest number
  crossing.barycentric = areas / total;
  crossing.fraction =
      crossing.barycentric.dot(Eigen::Vector3d(a[2], b[2], c[2])) / segment.length();
  return crossing;
}

Eigen::Vector3d snap_to_edges(const Eigen::Vector3d& barycentric) {
  const Eigen::Vector3d inside = (barycentric.array() < kContactOnEdge).select(0, barycentric);
  return inside / inside.sum();
}

double area_of_lengths(double a, double b, double c) {
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
  return product > 0 ? std::sqrt(product) / 4 : 0;
}

double angle_of_lengths(double a, double b, double c) {
  return std::atan2(4 * area_of_lengths(a, b, c), a * a + (b - c) * (b + c));
}

Eigen::Vector2d apex_of_lengths(double base, double from_start, double from_end) {
  const double x = (base + (from_start - from_end) * (from_start + from_end) / base) / 2;
  return {x, 2 * area_of_lengths(base, from_start, from_end) / base};
}

}  // namespace palpate::geometry
