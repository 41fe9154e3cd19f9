// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace palpate::geometry {

/// The three corners of a triangle.
using Corners = std::array<Eigen::Vector3d, 3>;

/// The point with these barycentric coordinates. Computed relative to one corner: far from the
/// origin a weighted sum of the corners would lose digits.
[[nodiscard]] inline Eigen::Vector3d point_on(const Corners& corners,
                                              const Eigen::Vector3d& barycentric) {
  const auto& [a, b, c] = corners;
  return a + (barycentric[1] * (b - a) + barycentric[2] * (c - a));
}

/// A contact is snapped to a corner or an edge iff its barycentric coordinates are this close to 1
/// or 0. This moves it by less than any measurement error, and avoids thinner triangles.
inline constexpr double kContactOnEdge = 1e-4;

/// Snaps the barycentric coordinates of a contact to a corner or an edge if it is close to one;
/// they sum to 1.
[[nodiscard]] Eigen::Vector3d snap_to_edges(const Eigen::Vector3d& barycentric);

/// [mm^2] vector along the normal of a triangle, with the length of its area. `vertices`: 3 x N.
[[nodiscard]] Eigen::Vector3d area_vector(const Eigen::Matrix3Xd& vertices,
                                          const Eigen::Vector3i& triangle);

/// Unit normal of a triangle; NaN for one without area (the sine of the angle at its first corner
/// is zero within rounding).
[[nodiscard]] Eigen::Vector3d unit_normal(const Corners& corners);

/// The nearest point on a triangle.
struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< >= 0, sums to 1
};

/// Finds the nearest point of a triangle, which may be a needle or have zero area. The distance is
/// that to the point given by `barycentric`; infinite if its square overflows.
[[nodiscard]] Nearest nearest_on_triangle(const Eigen::Vector3d& point, const Corners& corners);

/// A segment in the form of Woop, Benthin and Wald 2013: axis 2 is the axis of its largest extent,
/// and a shear aligns the segment with it. Neighbouring triangles see their common edge with
/// exactly opposite signs, so no segment passes between them. Precondition: the ends differ.
class ShearedSegment {
 public:
  ShearedSegment(const Eigen::Vector3d& start, const Eigen::Vector3d& end) : start_(start) {
    const Eigen::Vector3d along = end - start;
    // Without branches, which a processor could only guess, and without divisions by 3.
    const Eigen::Array3d extent = along.cwiseAbs();
    const int larger = extent[1] > extent[0] ? 1 : 0;
    const int largest = extent[2] > std::max(extent[0], extent[1]) ? 2 : larger;
    // Static: a table on the stack would be read in other pieces than it was just written in, and
    // processors wait long for that.
    static constexpr std::array<std::array<int, 3>, 3> kOrders = {
        {{1, 2, 0}, {2, 0, 1}, {0, 1, 2}}};
    axis_ = kOrders[static_cast<std::size_t>(largest)];
    length_ = along[axis_[2]];
    shear_0_ = along[axis_[0]] / length_;
    shear_1_ = along[axis_[1]] / length_;
  }
  [[nodiscard]] Eigen::Vector3d shear(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d q = point - start_;
    return {q[axis_[0]] - shear_0_ * q[axis_[2]], q[axis_[1]] - shear_1_ * q[axis_[2]],
            q[axis_[2]]};
  }
  [[nodiscard]] double length() const { return length_; }                 ///< signed, along axis 2
  [[nodiscard]] const std::array<int, 3>& axis() const { return axis_; }  ///< new order of the axes
  [[nodiscard]] double shear_0() const { return shear_0_; }
  [[nodiscard]] double shear_1() const { return shear_1_; }
  /// 1 or -1 along axis 2, from start to end.
  [[nodiscard]] Eigen::Vector3d direction() const;

 private:
  Eigen::Vector3d start_;
  std::array<int, 3> axis_;
  double length_;
  double shear_0_;
  double shear_1_;
};

/// The crossing of a segment and a triangle.
struct Crossing {
  double fraction = std::numeric_limits<double>::infinity();  ///< in [0, 1]; infinity if none
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();      ///< >= 0, sums to 1
};

/// Crossing from either side, border included; none if the segment lies in the triangle's plane.
[[nodiscard]] Crossing cross_triangle(const ShearedSegment& segment, const Corners& corners);

/// The crossing of a triangle and the line through a segment, which is shifted sideways by an
/// infinitesimal distance; the fraction may be any number, infinite if the line passes beside it.
/// The shift is the same for all triangles and the sides of edges are exact, so that a line through
/// an edge or a vertex crosses a closed surface as often outwards as inwards. None if the line lies
/// in the plane of the triangle.
[[nodiscard]] Crossing cross_triangle_beside_edges(const ShearedSegment& segment,
                                                   const Corners& corners);

/// Area of a triangle from the lengths of its sides, accurate also for needles (Kahan 2014); 0 if
/// the lengths violate the triangle inequality.
[[nodiscard]] double area_of_lengths(double a, double b, double c);

/// Angle between the sides `a` and `b` of a triangle, opposite to `c`; in [0, pi].
[[nodiscard]] double angle_of_lengths(double a, double b, double c);

/// Apex of a triangle on the left of its base, which runs from the origin along x.
[[nodiscard]] Eigen::Vector2d apex_of_lengths(double base, double from_start, double from_end);

[[nodiscard]] inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace palpate::geometry
