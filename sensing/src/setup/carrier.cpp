// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/carrier.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

/// Shorter periods than this [camera px] are lost between the pixels (Nyquist).
constexpr double kLeastPeriod = 2;

/// Rejects a sinusoid of which the camera sees no full period, or cannot resolve the periods.
void check_period(const Carrier& carrier, const Pattern& pattern, const geometry::Camera& camera) {
  const double period = carrier.period();
  const int length = carrier.transposed ? camera.width : camera.height;
  if (period >= kLeastPeriod && period <= length) return;
  throw InvalidInput("pattern: period_px: " + std::to_string(pattern.period) +
                     " projector pixels appear as about " + std::to_string(period) +
                     " px in the camera's image; 2 to " + std::to_string(length) +
                     " px can be decoded");
}

}  // namespace

Carrier expected_carrier(const Rig& rig, const Pattern& pattern) {
  const Triangulation triangulation(rig);
  const double baseline = rig.T_projector_camera.translation().norm();
  // Sums over all samples of d(projector pixel) / d(camera pixel).
  Eigen::Matrix2d gradient = Eigen::Matrix2d::Zero();
  double log_z = 0;
  double count = 0;
  for (int step = 0; step < kTriedDepths; ++step) {
    const double z = baseline * std::pow(kFarthestBaselines, step / (kTriedDepths - 1.0));
    for (int place = 0; place < kPlacesPerSide * kPlacesPerSide; ++place) {
      const int across = place % kPlacesPerSide;
      const int down = place / kPlacesPerSide;
      const Eigen::Vector2d pixel((across + 0.5) / kPlacesPerSide * rig.camera.width,
                                  (down + 0.5) / kPlacesPerSide * rig.camera.height);
      const auto projected = [&](double du, double dv) {
        const Eigen::Vector2d ray =
            geometry::undistort(rig.camera, pixel + Eigen::Vector2d(du, dv));
        return triangulation.project(triangulation.direction(ray), z);
      };
      Eigen::Matrix2d local;
      local.col(0) = projected(0.5, 0) - projected(-0.5, 0);
      local.col(1) = projected(0, 0.5) - projected(0, -0.5);
      if (!triangulation.on_panel(projected(0, 0)) || !local.allFinite()) continue;
      gradient += local;
      log_z += std::log(z);
      count += 1;
    }
  }
  if (count == 0) {
    throw InvalidInput(
        "rig: the projector lights nothing of what the camera sees, at no depth up to " +
        std::to_string(kFarthestBaselines * baseline) + " mm; check R and t");
  }
  gradient /= count;
  const int row = pattern.axis == Axis::x ? 0 : 1;
  const Eigen::Vector2d phase = 2 * std::numbers::pi / pattern.period * gradient.row(row);
  const Eigen::Vector2d stripes = gradient.row(1 - row);
  const bool transposed = std::abs(phase.x()) > std::abs(phase.y());
  const Carrier carrier{.transposed = transposed,
                        .along = transposed ? phase.x() : phase.y(),
                        .across = transposed ? phase.y() : phase.x(),
                        .z = std::exp(log_z / count),
                        .stripes_reversed = (transposed ? stripes.y() : stripes.x()) < 0};
  check_period(carrier, pattern, rig.camera);
  return carrier;
}

double stripe_width(const Carrier& carrier, const Pattern& pattern) {
  const std::vector<double>& edges = pattern.stripe_edges;
  const double on_panel =
      edges.size() < 2 ? pattern.period
                       : (edges.back() - edges.front()) / static_cast<double>(edges.size() - 1);
  return on_panel * carrier.period() / pattern.period;
}

}  // namespace palpate::sensing
