// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/slip_detection.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::probing {
namespace {

bool is_complete(const SlipTrial& trial) {
  return trial.contact.allFinite() && trial.a.allFinite() && trial.creep.allFinite() &&
         trial.normal_force.allFinite() && trial.tangential_force.allFinite() &&
         trial.normal_force.norm() > 0 && trial.tangential_force.norm() > 0 &&
         (trial.fell_off || (trial.b.allFinite() && trial.a_again.allFinite()));
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

}  // namespace palpate::probing
