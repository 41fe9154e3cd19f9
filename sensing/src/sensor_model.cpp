// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "sensor_model.h"

#include <cmath>
#include <numbers>

namespace palpate::sensing {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

SensorModel::SensorModel(const Rig& rig, const Pattern& pattern)
    : rig_((check_rig(rig, "rig"), rig)),
      pattern_((check_pattern(pattern, "pattern"), pattern)),
      triangulation_(rig),
      carrier_(expected_carrier(rig, pattern)),
      rows_(carrier_.transposed ? rig.camera.width : rig.camera.height),
      columns_(carrier_.transposed ? rig.camera.height : rig.camera.width),
      axis_(pattern.axis == Axis::x ? 0 : 1),
      directions_(3, rows_ * columns_) {
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(rig.camera);
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column) {
      const long ray = carrier_.transposed ? column * rows_ + row : row * columns_ + column;
      directions_.col(row * columns_ + column) = triangulation_.direction(rays.col(ray));
    }
  }
  prepare_chromatic(rays);
}

void SensorModel::prepare_chromatic(const Eigen::Matrix2Xd& rays) {
  Plane& expected = chromatic_.expected_pixel;
  expected.resize(rows_, columns_);
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel = triangulation_.project(direction(row, column), carrier_.z);
      expected(row, column) = static_cast<float>(pixel[axis_]);
    }
  }
  const ChromaticShift* const shifts[] = {&rig_.red, &rig_.blue};
  for (std::size_t i = 0; i < 2; ++i) {
    chromatic_.channels[i] =
        channel_model(channel_shift(rig_.camera, shifts[i]->alpha, rays, carrier_),
                      chromatic_lag(*shifts[i], rig_.projector, pattern_), expected);
  }
}

std::optional<double> SensorModel::phase_at_depth(long row, long column, double z) const {
  const Eigen::Vector2d pixel = triangulation_.project(direction(row, column), z);
  if (!triangulation_.on_panel(pixel)) return std::nullopt;
  return kTurn * pixel[axis_] / pattern_.period + pattern_.phase -
         carrier_.along * static_cast<double>(row);
}

std::optional<double> SensorModel::phase_at_edge(long row, long column, int edge) const {
  const Axis across = pattern_.axis == Axis::x ? Axis::y : Axis::x;
  const double pixel = pattern_.stripe_edges[static_cast<std::size_t>(edge)];
  return phase_at_depth(row, column, triangulation_.depth(direction(row, column), across, pixel));
}

SensorModel::Surface SensorModel::surface_at(long row, long column, double phase,
                                             const ChannelShares& shares,
                                             double max_sensitivity) const {
  const double per_pixel = kTurn / pattern_.period;
  double pixel = (phase + carrier_.along * static_cast<double>(row) - pattern_.phase) / per_pixel;
  if (shares.red.size() > 0) {
    // The lags were taken at the carrier's depth; now the projector pixel is known, and with it by
    // how much the phase of the sum moves (to first order in the lags, which are small).
    const double moved = pixel - static_cast<double>(chromatic_.expected_pixel(row, column));
    pixel += moved / per_pixel *
             (static_cast<double>(shares.red(row, column)) * chromatic_.channels[0].lag.slope +
              static_cast<double>(shares.blue(row, column)) * chromatic_.channels[1].lag.slope);
  }
  const Eigen::Vector3d ray = direction(row, column);
  const double z = triangulation_.depth(ray, pattern_.axis, pixel);
  const Eigen::Vector2d lit_by = triangulation_.project(ray, z);
  if (!triangulation_.on_panel(lit_by)) return {z, lit_by, Reason::off_panel};
  const double phase_per_mm = per_pixel * triangulation_.slope(ray, pattern_.axis, z);
  const bool sharp = std::abs(phase_per_mm) * max_sensitivity * z >= 1;
  return {z, lit_by, sharp ? Reason::reconstructed : Reason::grazing};
}

}  // namespace palpate::sensing
