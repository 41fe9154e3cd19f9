// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/triangulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::sensing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The secant method stops when the projector pixel is within this [px], a thousandth of the
/// resolution of the phase.
constexpr double kPixelTolerance = 1e-6;
/// The number of digits grows 1.6 times per step; lenses whose image does not fold need 4 or 5
/// steps.
constexpr int kMaxSecantSteps = 20;

}  // namespace

Triangulation::Triangulation(const Rig& rig)
    : projector_(rig.projector),
      distorted_(std::any_of(projector_.distortion.begin(), projector_.distortion.end(),
                             [](double k) { return k != 0; })),
      rotation_(rig.T_projector_camera.linear()),
      translation_(rig.T_projector_camera.translation()) {}

Eigen::Vector2d Triangulation::project(const Eigen::Vector3d& direction, double z) const {
  const Eigen::Vector3d point = z * direction + translation_;
  if (!(point.z() > 0)) return Eigen::Vector2d::Constant(kNaN);
  const Eigen::Vector2d normalized = point.hnormalized();
  if (distorted_) return geometry::distort(projector_, normalized);
  return {projector_.fx * normalized.x() + projector_.cx,
          projector_.fy * normalized.y() + projector_.cy};
}

double Triangulation::plane_depth(const Eigen::Vector3d& direction, int row,
                                  double normalized) const {
  const double z = (translation_[row] - normalized * translation_.z()) /
                   (normalized * direction.z() - direction[row]);
  return z > 0 && z * direction.z() + translation_.z() > 0 ? z : kNaN;
}

double Triangulation::depth(const Eigen::Vector3d& direction, Axis axis, double pixel) const {
  const int row = axis == Axis::x ? 0 : 1;
  const double focal = axis == Axis::x ? projector_.fx : projector_.fy;
  const double center = axis == Axis::x ? projector_.cx : projector_.cy;
  double normalized = (pixel - center) / focal;
  double z = plane_depth(direction, row, normalized);
  if (!distorted_) return z;
  // The secant method on the undistorted coordinate; the first step assumes a lens without
  // distortion (slope one).
  double miss = project(direction, z)[row] - pixel;
  if (std::abs(miss) <= kPixelTolerance) return z;
  double next = normalized - miss / focal;
  for (int step = 0; step < kMaxSecantSteps; ++step) {
    z = plane_depth(direction, row, next);
    const double next_miss = project(direction, z)[row] - pixel;
    if (std::abs(next_miss) <= kPixelTolerance) return z;
    const double slope = (next_miss - miss) / (next - normalized);
    if (!(slope > 0)) return kNaN;  // a fold of the lens, or NaN
    normalized = next;
    miss = next_miss;
    next -= miss / slope;
  }
  return kNaN;
}

double Triangulation::slope(const Eigen::Vector3d& direction, Axis axis, double z) const {
  const int row = axis == Axis::x ? 0 : 1;
  const double focal = axis == Axis::x ? projector_.fx : projector_.fy;
  const double depth = z * direction.z() + translation_.z();
  return focal * (direction[row] * translation_.z() - translation_[row] * direction.z()) /
         (depth * depth);
}

bool Triangulation::on_panel(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.x() <= projector_.width - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() <= projector_.height - 0.5;
}

}  // namespace palpate::sensing
