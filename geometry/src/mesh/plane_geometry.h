// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::geometry {

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
