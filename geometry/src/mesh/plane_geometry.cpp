// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/plane_geometry.h"

#include <cmath>
#include <utility>

namespace palpate::geometry {

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
