// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/slip_detection.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "palpate/core/quantile.h"

namespace palpate::probing {
namespace {

bool is_complete(const SlipTrial& trial) {
  return trial.contact.allFinite() && trial.a.allFinite() && trial.creep.allFinite() &&
         trial.normal_force.allFinite() && trial.tangential_force.allFinite() &&
         trial.normal_force.norm() > 0 && trial.tangential_force.norm() > 0 &&
         (trial.fell_off || (trial.b.allFinite() && trial.a_again.allFinite()));
}

/// Deviations that are added to the learnt share of microslip. The threshold of T^2 allows for the
/// noise of the trial itself.
constexpr double kCautious = 1;

// The threshold per median of T^2: chi^2 with one degree of freedom is above 15.14 once in 10,000,
// and above 0.455 in half of the cases.
constexpr double kThresholdPerMedian = 15.14 / 0.455;
constexpr std::size_t kFewestHeld = 12;
constexpr double kLeastThreshold = 1.0 / 16;  // of the usual one

// Share of the displacement that stays after a drag with `load` times the limit, relative to that
// at the limit: the way that stays by Mindlin and Deresiewicz (1953), per force. The displacement
// grows at least as fast as the force.
double relative_microslip(double load) {
  constexpr double kTwoThirds = 2.0 / 3;
  const auto stays = [](double x) {
    return 2 * std::pow(1 - x / 2, kTwoThirds) - std::pow(1 - x, kTwoThirds) - 1;
  };
  return stays(load) / (load * stays(1));
}

}  // namespace

Eigen::Matrix3d measured_compliance(const SlipTrial& trial) noexcept {
  const Eigen::Vector3d normal = trial.normal_force.normalized();
  const Eigen::Vector3d along =
      (trial.tangential_force - trial.tangential_force.dot(normal) * normal).normalized();
  const Eigen::Vector3d across = normal.cross(along);
  const double pressed = (trial.a - trial.contact).norm() / trial.normal_force.norm();
  const double dragged = (trial.b - trial.a).norm() / trial.tangential_force.norm();
  return pressed * normal * normal.transpose() + dragged * along * along.transpose() +
         std::max(pressed, dragged) * across * across.transpose();
}

std::optional<SlipJudgement> judge_slip(const SlipTrial& trial,
                                        const SlipOptions& options) noexcept {
  if (!is_complete(trial)) return std::nullopt;
  SlipJudgement judgement;
  if (trial.fell_off) {
    judgement.slipped = true;
    judgement.t_squared = std::numeric_limits<double>::infinity();
    judgement.distance = std::numeric_limits<double>::infinity();
    return judgement;
  }
  Eigen::Vector3d offset = trial.a_again - trial.a - trial.creep;
  judgement.distance = offset.norm();
  const Eigen::Vector3d dragged = trial.b - trial.a;
  const double length = dragged.norm();
  if (length > 0) {
    const Eigen::Vector3d along = dragged / length;
    offset -= std::clamp(offset.dot(along), 0.0, options.microslip * length) * along;
  }
  const Eigen::Matrix3d compliance = measured_compliance(trial);
  const Eigen::Matrix3d covariance =
      2 * (options.position_deviation * options.position_deviation * Eigen::Matrix3d::Identity() +
           options.force_deviation * options.force_deviation * compliance * compliance.transpose());
  judgement.t_squared = offset.dot(covariance.llt().solve(offset));
  judgement.slipped = judgement.t_squared > options.threshold;
  return judgement;
}

std::optional<HeldDrag> held_drag(const SlipTrial& trial, const SlipOptions& options) noexcept {
  if (!is_complete(trial) || trial.fell_off) return std::nullopt;
  const Eigen::Vector3d dragged = trial.b - trial.a;
  const double length = dragged.norm();
  if (!(length > 0)) return std::nullopt;
  const double force = trial.tangential_force.norm();
  return HeldDrag{
      .ratio = force / trial.normal_force.norm(),
      .share = (trial.a_again - trial.a - trial.creep).dot(dragged) / (length * length),
      .share_deviation = std::numbers::sqrt2 * std::hypot(options.position_deviation / length,
                                                          options.force_deviation / force)};
}

double allowed_microslip(std::span<const HeldDrag> drags, double ratio, double most) noexcept {
  double product = 0, square = 0;  // of a weighted least-squares line through zero
  for (const HeldDrag& drag : drags) {
    const double relative = relative_microslip(std::min(drag.ratio / ratio, 1.0));
    const double weight = 1 / (drag.share_deviation * drag.share_deviation);
    product += weight * relative * drag.share;
    square += weight * relative * relative;
  }
  if (!(square > 0)) return most;
  const double at_limit = std::max(product / square, 0.0) + kCautious / std::sqrt(square);
  return std::min(at_limit, most);
}

double allowed_threshold(std::span<const double> held, double most) {
  if (held.size() < kFewestHeld) return most;
  const double median = palpate::median(held);
  return std::clamp(kThresholdPerMedian * median, kLeastThreshold * most, most);
}

}  // namespace palpate::probing
